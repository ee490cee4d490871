"""The plant in a process of its own, its arithmetic pinned or not: plant_elsewhere.py here|elsewhere.

Prints as JSON for which processor the code is, which kernels OpenBLAS has taken, and a digest of every number of the
state that the machine has come to. Libraries that are loaded before a package of ours choose as they like.
"""

import ctypes
import dataclasses
import hashlib
import json
import os
import sys
from pathlib import Path

PERIODS = 15
WHEEL_RATE = 0.5
"""[rad/s]"""


def use_what_the_outside_says() -> None:
    """Load the libraries before any package of ours, and have numba compile for what it was told then."""
    told = os.environ["NUMBA_CPU_NAME"]
    import scipy.linalg  # noqa: F401 - with it both OpenBLAS are there

    import sojourn_machine  # noqa: F401 - pins what is not read any more, but for numba

    os.environ["NUMBA_CPU_NAME"], os.environ["NUMBA_CPU_FEATURES"] = told, ""


def driven() -> str:
    """Digest of the machine's state, after the wheels have turned for a while."""
    import numpy as np

    from sojourn_bringup.references import REFERENCES, references_folder
    from sojourn_config.scenario import load_scenario
    from sojourn_physics.plant.state import zeros_command
    from sojourn_physics.plant.step import step
    from sojourn_plant.start import build_plant

    model, state = build_plant(load_scenario(str(references_folder() / f"{REFERENCES[0].name}.yaml")))
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    command.reference[1, model.reference_rows([wheel.joint for wheel in model.machine.wheels])] = WHEEL_RATE
    begin = state.configuration[:2]
    for _ in range(PERIODS):
        state, _ = step(model, state, command)
    assert np.hypot(*(state.configuration[:2] - begin)) > 1e-3, "it stands"
    digest = hashlib.sha256()
    energy = np.array(dataclasses.astuple(state.energy))
    for numbers in (state.configuration, state.velocity, *state.supports, state.joints, energy):
        digest.update(np.ascontiguousarray(numbers).tobytes())
    return digest.hexdigest()


def kernels() -> list[str]:
    """Name of the processor for which each OpenBLAS has its kernels."""
    found = set()
    for file in {line.split()[-1] for line in Path("/proc/self/maps").read_text().splitlines() if "openblas" in line}:
        for suffix in ("64_", ""):
            name = getattr(ctypes.CDLL(file), f"scipy_openblas_get_corename{suffix}", None)
            if name is not None:
                name.restype = ctypes.c_char_p
                found.add(name().decode())
    return sorted(found)


if __name__ == "__main__":
    if sys.argv[1] == "elsewhere":
        use_what_the_outside_says()
    else:
        import sojourn_machine  # noqa: F401 - before numpy
    state = driven()
    from numba.core.registry import cpu_target

    code = cpu_target.target_context.codegen().magic_tuple()[1]
    print(json.dumps({"code": code, "kernels": kernels(), "state": state}))
