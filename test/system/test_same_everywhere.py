"""One record whatever the machine: whole runs in all three layouts, with settings from outside, in other code.

What no test on one machine can show is another make of processor. Its part is taken by the choices that a processor
makes: which instructions numba compiles for, which kernels OpenBLAS takes, which functions numpy has, and on how many
threads they run.
"""

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest
from programs import ELSEWHERE, FOUR_THREADS, PATIENT, Program
from verdicts import require_same

from domains import domain_to_keep
from sojourn_bags.reading import Bag, read_bag
from sojourn_bringup.references import REFERENCES, references_folder
from sojourn_machine import arithmetic

PLANT = Path(__file__).parent / "plant_elsewhere.py"
DEMO = ("lunar_sample", *PATIENT, "--set", "duration_limit_s=60.0")
REFERENCE = (
    str(references_folder() / f"{REFERENCES[0].name}.yaml"),
    *PATIENT,
    *(word for text in REFERENCES[0].overrides for word in ("--set", text)),
)


def records(folder: Path, runs: Mapping[str, tuple[tuple[str, ...], dict[str, str]]], status: int) -> dict[str, Bag]:
    """Bags of runs that go on at the same time.

    Args:
        runs: options of scripts/start.py, and variables set outside, by name. status: with which all must end.
    """
    programs: dict[str, Program] = {}
    try:
        for name, (options, outside) in runs.items():
            place = ["--domain", str(domain_to_keep()), "--run-dir", str(folder / name)]
            programs[name] = Program("start", [*options, *place], folder / f"{name}.log", outside)
        for program in programs.values():
            assert program.wait() == status, program.text
    finally:
        for program in programs.values():
            program.end()
    return {name: read_bag(folder / name) for name in runs}


def test_a_whole_run_is_the_same_without_middleware_in_one_process_and_in_many(tmp_path: Path) -> None:
    """A minute over rocks, where a last bit that is off grows beyond bounds. OpenBLAS is told to use four threads."""
    runs = {
        "direct": ((*DEMO, "--direct"), FOUR_THREADS),
        "composed": ((*DEMO, "--composed"), FOUR_THREADS),
        "processes": (DEMO, {}),
    }
    bags = records(tmp_path, runs, status=1)
    require_same(bags["direct"], bags["composed"])
    require_same(bags["composed"], bags["processes"])
    assert bags["direct"]["/clock"].times[-1] > 59.0


def test_the_reference_run_heeds_no_setting_of_the_outside(tmp_path: Path) -> None:
    composed = (*REFERENCE, "--composed")
    bags = records(tmp_path, {"here": (composed, {}), "elsewhere": (composed, ELSEWHERE)}, status=1)
    require_same(bags["here"], bags["elsewhere"])


def plant(manner: str, outside: Mapping[str, str]) -> dict[str, object]:
    """What plant_elsewhere.py prints."""
    environment = {**arithmetic.outer(os.environ), **outside}
    done = subprocess.run([sys.executable, PLANT, manner], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return dict(json.loads(done.stdout))


@pytest.mark.skipif("NUMBA_CPU_NAME" not in arithmetic.pins(), reason="no x86-64-v3: there is one code generator only")
def test_the_plant_computes_the_same_in_other_code(tmp_path: Path) -> None:
    """Compiled for another make of the same kind, and with the kernels that OpenBLAS takes there."""
    other = {
        "NUMBA_CPU_NAME": "znver3",
        "OPENBLAS_CORETYPE": "Zen",
        "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR",
        "NUMBA_CACHE_DIR": str(tmp_path),
    }
    here, elsewhere = plant("here", {}), plant("elsewhere", other)
    assert here["code"] == "x86-64-v3" and elsewhere["code"] == "znver3"
    assert here["state"] == elsewhere["state"]
