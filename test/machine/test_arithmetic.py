"""The arithmetic is the same on every machine: what is set, what it overrules, and that the libraries heed it."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from sojourn_machine import arithmetic

PROGRAM = """
import PACKAGE
import ctypes, json
import numpy, numba, scipy.linalg
from llvmlite import binding
from numba.core.registry import cpu_target
from numpy._core._multiarray_umath import __cpu_features__ as features

libraries = {line.split()[-1] for line in open("/proc/self/maps") if "openblas" in line}
cores, threads = [], []
for library in map(ctypes.CDLL, libraries):
    for suffix in ("64_", ""):
        name = getattr(library, "scipy_openblas_get_corename" + suffix, None)
        if name is not None:
            name.restype = ctypes.c_char_p
            cores.append(name().decode())
            threads.append(getattr(library, "scipy_openblas_get_num_threads" + suffix)())
print(json.dumps({
    "cores": cores, "threads": threads, "numba threads": numba.get_num_threads(),
    "code": list(cpu_target.target_context.codegen().magic_tuple()[1:]),
    "newer": [name for name in ("X86_V4", "AVX512_ICL", "AVX512_SPR") if features.get(name)],
}))
"""
PACKAGES = sorted(path.parent.name for path in (Path(__file__).parents[2] / "src").glob("*/package.xml"))
ELSEWHERE = {
    "OPENBLAS_NUM_THREADS": "4", "OMP_NUM_THREADS": "4", "NUMBA_NUM_THREADS": "2", "OPENBLAS_CORETYPE": "Sandybridge",
    "NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "+sse2",
}  # fmt: skip


def libraries_in(package: str, **outside: str) -> dict[str, Any]:
    """How the libraries compute in a process that imports a package of ours first."""
    environment = {**arithmetic.outer(os.environ), **outside}
    command = [sys.executable, "-c", PROGRAM.replace("PACKAGE", package)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return dict(json.loads(done.stdout))


@pytest.mark.skipif(not arithmetic.has_v3(arithmetic._flags()), reason="the processor is not of x86-64-v3")
@pytest.mark.parametrize("package", PACKAGES)
def test_every_library_heeds_it_whichever_package_comes_first(package: str) -> None:
    found = libraries_in(package, **ELSEWHERE)
    assert set(found["cores"]) == {"Haswell"} and set(found["threads"]) == {1}
    assert found["numba threads"] == 1 and found["code"] == ["x86-64-v3", ""]
    assert not found["newer"]


def test_what_was_outside_comes_back_whole() -> None:
    outside = {"OMP_NUM_THREADS": "3", "NUMBA_CPU_NAME": "generic", "PATH": "/usr/bin"}
    environment = dict(outside)
    arithmetic.pin(environment)
    assert environment["OMP_NUM_THREADS"] == "1" and environment["PATH"] == "/usr/bin"
    pinned = dict(environment)
    arithmetic.pin(environment)
    assert environment == pinned
    assert arithmetic.outer(environment) == outside
    assert arithmetic.outer(outside) == outside


def test_only_a_processor_that_can_is_asked_for_v3() -> None:
    flags = {"sse2", *arithmetic.NEEDED_FLAGS}
    assert arithmetic.has_v3(flags, "x86_64") and not arithmetic.has_v3(flags, "aarch64")
    for flag in arithmetic.NEEDED_FLAGS:
        assert not arithmetic.has_v3(flags - {flag}, "x86_64")
