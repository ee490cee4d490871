"""A kind of mobility from a package that is not ours: registered by an entry point; nothing of this repository is
edited. The drive, its goals, its odometry and the contract know the machine by the interface alone.
"""

import os
import subprocess
import sys
from pathlib import Path

import yaml

PARAMS = '''
"""Two sides that are driven against each other, in the fewest words."""

from typing import Literal

from pydantic import Field

from sojourn_flight.mobility.choice import MobilityChoice


class TwoSidesParams(MobilityChoice):
    kind: Literal["two_sides"]
    radius: float = Field(gt=0.0, description="of the wheels [m]")
    base: float = Field(gt=0.0, description="free-rolling distance of the sides [m]")

    def joints(self, machine):
        return tuple(wheel.joint for wheel in machine.wheels)

    def build(self, drive, body):
        from two_sides.mobility import TwoSides

        return TwoSides(drive, self, body)
'''
MOBILITY = '''
import numpy as np

from sojourn_flight.mobility.ability import Ability, TurningLimits
from sojourn_flight.mobility.mobility import BodyMotion, JointReferences, Mobility, MobilityHealth, Moves
from sojourn_flight.mobility.twist import NO_MOTION


class TwoSides(Mobility):
    """State: the last commanded rates of both sides."""

    def __init__(self, drive, params, body):
        self.params, self.joints, self.limits = params, params.joints(body.machine), drive.limits
        places = np.array([body.joints[joint].place[:2] for joint in self.joints])
        self.left = places[:, 1] > 0.0
        self.ability = Ability(TurningLimits(drive.follower.max_curvature, 1.0, True),
                               float(np.hypot(*places.T).max()), places)

    def initial_state(self):
        return (0.0, 0.0)

    def motion(self, state, inputs, dt):
        speeds = self.params.radius * inputs.joints.velocity
        left, right = speeds[self.left].mean(), speeds[~self.left].mean()
        motion = BodyMotion(0.5 * (left + right), 0.0, (right - left) / self.params.base, float(np.ptp(speeds)),
                            float(np.abs(speeds).max()), state == (0.0, 0.0))
        return state, motion

    def command(self, state, wanted, conditions, dt):
        limits = self.limits
        factor = min(1.0, limits.max_speed / max(abs(wanted.v_x), 1e-9),
                     limits.max_yaw_rate / max(abs(wanted.yaw_rate), 1e-9)) * conditions.power
        turn = 0.5 * self.params.base * wanted.yaw_rate
        most, asked = limits.max_deceleration * dt, (factor * (wanted.v_x - turn), factor * (wanted.v_x + turn))
        state = tuple(old + min(max(new - old, -most), most) for old, new in zip(state, asked))
        rates = np.where(self.left, state[0], state[1]) / self.params.radius
        return state, Moves(JointReferences(np.zeros(len(rates)), rates), factor)

    def fit(self, wanted):
        if wanted.v_y != 0.0:
            return NO_MOTION, "two sides go ahead, back and round, not aside"
        return wanted, ""

    def health(self, state, slip_error):
        return MobilityHealth()

    def warm_up(self):
        pass
'''
PROGRAM = """
import sys
from sojourn_bringup import contract_tool, start
from sojourn_config.scenario import load_scenario

print(load_scenario(sys.argv[1]).mobility())
started = start.main([sys.argv[1], "--direct", "--run-dir", sys.argv[2]])
raise SystemExit(started or contract_tool.main(["check", "--bag", sys.argv[2]]))
"""


def test_a_mobility_of_another_package_is_driven_to_its_goal(tmp_path: Path) -> None:
    package, known = tmp_path / "two_sides", tmp_path / "two_sides-1.0.dist-info"
    machine, run_dir = tmp_path / "machines" / "mine", tmp_path / "run"
    for folder in (package, known, machine):
        folder.mkdir(parents=True)
    for name, text in (("__init__", ""), ("params", PARAMS), ("mobility", MOBILITY)):
        (package / f"{name}.py").write_text(text, encoding="utf-8")
    (known / "METADATA").write_text("Metadata-Version: 2.1\nName: two_sides\nVersion: 1.0\n", encoding="utf-8")
    entry = "[sojourn.mobility]\ntwo_sides = two_sides.params:TwoSidesParams\n"
    (known / "entry_points.txt").write_text(entry, encoding="utf-8")
    config = Path(__file__).resolve().parents[3] / "config"
    for file in (config / "machines" / "skid").glob("*.yaml"):
        (machine / file.name).write_bytes(file.read_bytes())
    flight = yaml.safe_load((machine / "flight.yaml").read_text("utf-8"))
    part = yaml.safe_load((config / "parts" / "rover_flight.yaml").read_text("utf-8"))
    common = {key: value for key, value in part["drive"].items() if key != "mobility"}
    own = flight["drive"]
    merged = {**common, **own, **{key: {**common[key], **own[key]} for key in common if isinstance(own.get(key), dict)}}
    merged["mobility"] = {"kind": "two_sides", "radius": 0.18, "base": 1.42}
    flight = {"power_manager": flight["power_manager"], "drive": merged}
    (machine / "flight.yaml").write_text(yaml.safe_dump(flight), "utf-8")
    scenario = tmp_path / "two_sides.yaml"
    text = yaml.safe_load((config / "scenarios" / "flat_drive.yaml").read_text("utf-8"))
    steps = [{"drive_to": {"x": 2.0, "y": 1.0}, "timeout_s": 200.0}]
    scenario.write_text(yaml.safe_dump({**text, "machine": str(machine), "steps": steps}), "utf-8")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])}
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(scenario), str(run_dir)], env=environment, cwd=tmp_path,
        capture_output=True, text=True, timeout=1200,
    )  # fmt: skip
    assert run.returncode == 0, run.stdout + run.stderr
    assert "TwoSides" in run.stdout and "reached" in run.stdout, run.stdout
    assert "keeps the contract: no violation" in run.stdout, run.stdout
