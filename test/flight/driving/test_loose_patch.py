"""The slip policy driven: a patch of loose ground, felt by the torques of the wheels and by the accelerometer."""

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import pytest
from rolling_rover import DT, RollingRover

from sojourn_config.scenario import load_scenario
from sojourn_flight.odometry.traction import coefficient, in_rut
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.planning.way_back import SPACING
from sojourn_flight.supervision.slip_policy import speed_part
from sojourn_machine.params import FloatArray
from wheel_drive import WheelDrive, WheelInput, wheel_loads_of, with_mobility

FIRM = 0.12
"""Slip of the ground about the patch [-]."""
GRIP_TIME = 0.5
"""In which the slip of the machine follows that of the ground [s]."""
NEAR, FAR, SIDE = 3.0, 4.4, 0.7
"""The patch: from and to along x, to both sides [m]."""


@dataclass
class SlippingRover(RollingRover):
    """Its wheels slip by what the ground under them gives on average, and need the torque that the drive believes."""

    loose: float = FIRM
    """Slip of a machine with all wheels on the patch [-]."""
    endless: bool = False
    """All ground beyond NEAR is loose."""
    sees: bool = True
    """It has a camera."""
    slip: float = FIRM
    """Of the machine now [-]."""
    speed: float = 0.0
    """Over ground [m/s]."""

    def __post_init__(self) -> None:
        super().__post_init__()
        params = with_mobility(self.model.params, slip=self.scenario.drive.mobility.slip)
        camera = self.model.camera if self.sees else None
        self.model = WheelDrive(params, self.scenario.steering, camera, wheel_loads_of(self.scenario))
        self.state = self.model.initial_state()

    def on_patch(self) -> float:
        """Part of the wheels that stand on it."""
        x, y, yaw = self.place
        places = self.wheels @ np.array([[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]]) + (x, y)
        within = (places[:, 0] > NEAR) & ((places[:, 0] < FAR) & (np.abs(places[:, 1]) < SIDE) | self.endless)
        return float(within.mean())

    def felt(self, inputs: WheelInput) -> WheelInput:
        """The measurements with torques and specific force."""
        slip, model, state = self.model.mobility.slip_model, self.model, self.state.mobility.slip
        assert slip is not None and state is not None
        self.slip += min(DT / GRIP_TIME, 1.0) * (FIRM + (self.loose - FIRM) * self.on_patch() - self.slip)
        table = model.table
        rims = inputs.wheel_rates * table[:, 2]
        before, self.speed = self.speed, float(rims.mean()) * (1.0 - self.slip)
        ahead, levers = state.ahead, table[:, 2] * slip.machine.loads[:, 0]
        kinds = [int(in_rut(table, i, ahead[0], ahead[1], slip.params.rut_width, state.way)) for i in range(len(table))]
        torques = levers * np.array([coefficient(slip.machine.curves[kind], self.slip) for kind in kinds])
        return replace(
            inputs,
            wheel_efforts=torques * np.sign(rims),
            specific_force=((self.speed - before) / DT, 0.0, self.scenario.gravity),
        )


class Course(NamedTuple):
    """What became of a run, period by period, shape (periods,)."""

    rover: SlippingRover
    outcome: GoalOutcome | None
    x: FloatArray
    rim: FloatArray
    """Speed of the rims [m/s]."""
    mean: FloatArray
    """Averaged slip of the drive [-]."""
    true: FloatArray
    """Slip of the machine [-]."""
    loose: FloatArray
    """Part of the wheels on the patch [-]."""


def driven(**options: Any) -> Course:
    """Seven metres straight on, over the patch."""
    size = ["terrain.size_x=26.0", "terrain.size_y=20.0", "terrain.center_x=7.0", "terrain.resolution=0.05"]
    scenario = load_scenario("flat_drive", ["steps=[]", "start.x=0.0", "terrain.kind=generated", *size])
    made, rows = SlippingRover(scenario, **options), []
    for _ in range(20):
        made._step(None)
    outcome = next(iter(made._step(Goal.at(7.0, 0.0))), None)
    while outcome is None and made.period < 4000:
        outcome = next(iter(made._step(None)), None)
        rim = float((made.output.wheel_rates * made.model.table[:, 2]).mean())
        rows.append((made.place[0], rim, made.state.mean_slip, made.slip, made.on_patch()))
    return Course(made, outcome, *np.array(rows).T)


def test_from_0_4_on_it_drives_slower_as_far_as_it_says() -> None:
    """Two thirds of the wheels are on the patch at a time: 0.54 of slip, 0.65 of the speed; and no way round."""
    run = driven(loose=0.75)
    assert run.outcome is not None and run.outcome.kind == "reached"
    policy, avoidance = run.rover.model.params.slip_policy, run.rover.state.avoidance
    assert policy is not None and avoidance is not None and avoidance.detours == 0
    assert run.true.max() == pytest.approx(0.54, abs=0.01)
    assert abs(run.mean[run.loose > 0.5][-20:] - 0.54).max() < 0.05, "it knows its slip"
    steady = (run.x > 0.5) & (run.x < 6.4)
    expected = 0.1 * np.array([speed_part(policy, slip) for slip in run.mean])
    np.testing.assert_allclose(run.rim[steady], expected[steady], atol=0.01)
    assert run.rim[run.mean < policy.slow][20:-80].min() > 0.09
    assert run.rim[steady].min() == pytest.approx(0.065, abs=0.005)


def test_from_0_6_on_it_goes_back_and_takes_another_way() -> None:
    """0.67 of slip with its rear wheels on firm ground still."""
    run = driven(loose=0.95)
    policy, avoidance = run.rover.model.params.slip_policy, run.rover.state.avoidance
    assert run.outcome is not None and run.outcome.kind == "reached", run.outcome
    assert policy is not None and avoidance is not None and avoidance.detours >= 1
    assert policy.another_way < run.mean.max() < policy.another_way + 0.05
    least = policy.back - 1.25 * SPACING  # of the track; a quarter of it is left at the end
    assert run.rover.reversed >= least
    assert run.rim[run.x < NEAR + 1.0].min() < -0.04
    crossing = [y for x, y, _ in run.rover.track if NEAR < x < FAR]
    assert abs(crossing[-1]) > SIDE, "past the patch"


def test_at_0_85_the_goal_ends_where_there_is_no_camera_to_find_a_way_with() -> None:
    run = driven(loose=0.95, endless=True, sees=False)
    params = run.rover.model.params.mobility.slip
    assert run.outcome is not None and params is not None
    assert run.outcome.kind == "stopped"
    assert run.outcome.reason.startswith("spinning without headway (slip 0.9"), run.outcome.reason
    beyond = float((run.true > params.stuck_slip).sum()) * DT
    assert params.stuck_time <= beyond < params.stuck_time + 1.0
    assert run.rim[-2] == pytest.approx(0.05, abs=0.01), "and it had slowed down to half before"
