"""Motors that stand and hold, beside what their windings take of the same torque, and in a plan."""

import numpy as np
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_flight.power_manager.activities import Activities, ActivityParams
from sojourn_studies.standing_draw import standing_draw


def test_a_plan_has_them_from_the_first_activity_on() -> None:
    scenario = load_scenario("mars_sol")
    params = scenario.power_manager
    names = [load.name for load in params.loads]
    drawn = np.zeros(len(names))
    drawn[[names.index("drive"), names.index("arm")]] = 2.0, 0.1
    one = ActivityParams(load="drive", power_w=50.0, start_h=2.0, hours=1.5, every_h=24.66)
    plan = Activities(params, [one]).standing(drawn).times(1.2)
    at = [dict(zip(names, plan.demand(3600.0 * hour), strict=True)) for hour in (1.0, 3.0, 4.0, 27.0)]
    assert [one["drive"] for one in at] == pytest.approx([0.0, 60.0, 2.0, 60.0])
    assert [one["arm"] for one in at] == pytest.approx([0.1] * 4) and at[2]["computer"] == 0.0


def test_an_arm_holds_its_weight_and_wheels_what_they_are_wound_up_with() -> None:
    scenario = load_scenario("mars_sol")
    names = [load.name for load in scenario.power.loads]
    drawn = dict(zip(names, standing_draw(scenario), strict=True))
    assert drawn["computer"] == drawn["cameras"] == 0.0
    light = dict(
        zip(
            names, standing_draw(load_scenario("mars_sol", ["body=moon", "sun.time=2028-03-18T00:00:00Z"])), strict=True
        )
    )
    assert 0.5 < drawn["drive"] < 5.0 and drawn["arm"] > 0.03
    # the torque of an arm goes with the weight, its heat with the square
    assert light["arm"] < 0.6 * drawn["arm"] and light["drive"] < drawn["drive"]
