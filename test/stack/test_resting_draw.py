"""What motors hold with after a drive is found by the power manager from the current of the battery, in a whole run."""

from typing import Any

import pytest

from sojourn_flight.power_manager.resting_draw import GAIN
from sojourn_stack import run as direct

ROLES = ("plant", "sensors", "drive", "arm", "power", "operator")
STOP = (
    "machine=explorer",
    "steps=[{drive_to: {x: 0.4, y: 0.0}, timeout_s: 60.0}, {wait_s: 105.0}]",
    "duration_limit_s=200.0",
)
REST = 50.0
"""After the start of the run, when it has long stopped [s]."""


def test_the_forecast_knows_what_wheels_and_arm_hold_with_after_a_drive() -> None:
    """Two looks bring the belief so far towards the truth; a sensor's offset and noise count with it."""
    seen = list[tuple[float, float, float]]()

    def keep(state: Any) -> bool:
        plant, power = state.roles["plant"].app.machine, state.roles["power"].app
        seen.append((plant.tick * 0.02, plant.energy.electrical, power.held))
        return True

    result = direct.run(direct.RunSpec("mars_sol", ROLES, STOP), keep)
    assert [step.good for step in result.steps] == [True, True]
    rest = [(time, energy) for time, energy, _ in seen if time > REST]
    (begin, before), (end, after) = rest[0], rest[-1]
    truth, beliefs = (after - before) / (end - begin), list(dict.fromkeys(held for *_, held in seen))
    assert truth > 0.5 and len(beliefs) == 3 and beliefs[0] == 0.0
    for look, held in enumerate(beliefs):
        assert held == pytest.approx((1.0 - (1.0 - GAIN) ** look) * truth, abs=0.15 * truth)
