"""Settings by which a run has the same values on every machine, whatever the make of its processor and its cores.

Numba, OpenBLAS (one comes with numpy, another with scipy) and numpy itself choose their instructions by the processor
that they meet, and then round in another way. Here all of them are held to x86-64-v3: AVX2 and fused multiply-add, as
every Intel since Haswell (2013) and every AMD since Zen (2017) has them, and nothing newer. A sum that is shared among
threads is added up in another order, so all compute on one.

The libraries read these variables once, when they are loaded. Each package of ours therefore imports this one before
all else. Whoever imports numpy before a package of ours gets what the machine offers. Values of the outside
are overruled; a program that is not ours gets them back (`outer`).

Part of the version of the kernels, since njit compiles for what stands here: see `kernel_cache`.
"""

import os
import platform
from collections.abc import Iterable, Mapping, MutableMapping
from pathlib import Path

ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
INSTRUCTIONS = {
    "NUMBA_CPU_NAME": "x86-64-v3",
    "NUMBA_CPU_FEATURES": "",  # those of the name and no more; unset they would be the processor's
    "OPENBLAS_CORETYPE": "Haswell",
    "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR",
}
"""For a processor of x86-64-v3 or above. An older one, or one of another kind, computes as it can."""
NEEDED_FLAGS = frozenset({"avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe", "xsave"})
"""What x86-64-v3 adds (System V ABI for AMD64, 2020, table 3.1), as Linux names it."""
PINNED = "SOJOURN_PINNED"
"""Variable that names what we have set; PINNED_<name> keeps the value that was there before."""


def pin(environment: MutableMapping[str, str] = os.environ) -> None:
    """Set the variables in an environment, and keep what they were there. Once done, it changes nothing more."""
    settings = pins()
    if PINNED not in environment:
        for name in settings:
            if name in environment:
                environment[f"{PINNED}_{name}"] = environment[name]
        environment[PINNED] = " ".join(settings)
    environment.update(settings)


def pins() -> dict[str, str]:
    """The variables for this machine."""
    return ONE_THREAD | (INSTRUCTIONS if has_v3(_flags()) else {})


def outer(environment: Mapping[str, str]) -> dict[str, str]:
    """An environment as it was before it was pinned."""
    found = dict(environment)
    for name in found.pop(PINNED, "").split():
        found.pop(name, None)
        before = found.pop(f"{PINNED}_{name}", None)
        if before is not None:
            found[name] = before
    return found


def has_v3(flags: Iterable[str], machine: str = platform.machine()) -> bool:
    """Whether a processor with these flags is one of x86-64-v3."""
    return machine == "x86_64" and set(flags) >= NEEDED_FLAGS


def _flags() -> set[str]:
    """Flags of this machine's processor; none where Linux does not tell them."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return set()
    return next((set(line.partition(":")[2].split()) for line in lines if line.startswith("flags")), set())
