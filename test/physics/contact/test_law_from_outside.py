"""A contact law from a package that is not ours: registered by an entry point; nothing of this repository is edited."""

import os
import subprocess
import sys
from pathlib import Path

LAW = '''
"""A wheel on a carpet: a linear spring and viscous drag."""

from enum import IntEnum
from typing import Any, ClassVar, Literal

from sojourn_machine.kernels import kernel
from sojourn_physics.contact.contact_law import MotionColumn, OutColumn, WheelColumn
from sojourn_physics.contact.law_params import ContactLawParams


class CarpetColumn(IntEnum):
    STIFFNESS = WheelColumn.OWN
    DRAG = WheelColumn.OWN + 1


class CarpetParams(ContactLawParams):
    columns: ClassVar[type[IntEnum] | None] = CarpetColumn
    needs: ClassVar[tuple[str, ...]] = ()
    model: Literal["carpet"]
    stiffness: float
    drag: float

    @classmethod
    def law(cls) -> Any:
        return carpet


@kernel
def carpet(wheel, soil, motion, dt, state, out):
    slip = motion[MotionColumn.RIM_SPEED] - motion[MotionColumn.V_ALONG]
    out[OutColumn.FORCE_Z] = wheel[CarpetColumn.STIFFNESS] * motion[MotionColumn.PENETRATION]
    out[OutColumn.FORCE_X] = wheel[CarpetColumn.DRAG] * slip
    out[OutColumn.FORCE_Y] = -wheel[CarpetColumn.DRAG] * motion[MotionColumn.V_SIDE]
    out[OutColumn.TORQUE] = wheel[WheelColumn.RADIUS] * out[OutColumn.FORCE_X]
    out[OutColumn.SINKAGE] = motion[MotionColumn.PENETRATION]
'''
PROGRAM = """
import sys
from sojourn_config.scenario import load_scenario
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant

scenario = load_scenario(sys.argv[1])
model, state = build_plant(scenario)
command = zeros_command(len(model.joints.names), len(model.loads))
command.reference[0] = state.motor_angles
command.reference[1, model.reference_rows([wheel.joint for wheel in model.machine.wheels])] = 0.5
for _ in range(50):
    state, output = step(model, state, command)
wheels = output.contacts[: len(model.machine.wheels)]
off = abs(wheels[:, 8] - 30e3 * wheels[:, 3]).max()
print("carpet", model.machine.wheels[0].contact.model, off < 1e-6 * wheels[:, 8].max(), state.velocity[0] > 0.05)
"""


def test_a_law_of_another_package_drives_the_plant(tmp_path: Path) -> None:
    package, known = tmp_path / "carpets", tmp_path / "carpets-1.0.dist-info"
    machine = tmp_path / "machines" / "carpet_rover"
    for folder in (package, known, machine):
        folder.mkdir(parents=True)
    (package / "__init__.py").write_text("", encoding="utf-8")
    (package / "law.py").write_text(LAW, encoding="utf-8")
    (known / "METADATA").write_text("Metadata-Version: 2.1\nName: carpets\nVersion: 1.0\n", encoding="utf-8")
    (known / "entry_points.txt").write_text(
        "[sojourn.contact_laws]\ncarpet = carpets.law:CarpetParams\n", encoding="utf-8"
    )
    config = Path(__file__).resolve().parents[3] / "config"
    for file in (config / "machines" / "skid").glob("*.yaml"):
        (machine / file.name).write_bytes(file.read_bytes())
    wheel = machine / "wheel.yaml"
    wheel.write_text(wheel.read_text("utf-8") + "contact: {model: carpet, stiffness: 3.0e+4, drag: 900.0}\n", "utf-8")
    scenario = tmp_path / "on_carpet.yaml"
    text = (config / "scenarios" / "flat_drive.yaml").read_text("utf-8")
    assert "machine: explorer" in text
    scenario.write_text(text.replace("machine: explorer", f"machine: {machine}"), "utf-8")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])}
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(scenario)], env=environment, cwd=tmp_path, capture_output=True, text=True,
        timeout=1200,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == ["carpet", "carpet", "True", "True"]
