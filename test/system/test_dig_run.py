"""The arm at work on the whole stack: forces of a guarded move and of a dig, soil that is gone, what it weighs; and all
that the same without middleware and in many processes.
"""

from pathlib import Path

import numpy as np
import pytest
from programs import FOUR_THREADS, HERE, LAYOUTS, PATIENT
from test_same_everywhere import records
from verdicts import require_same

from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag

TIP = -1
"""Of the contacts: the tool is the last pad."""


def said(bag: Bag, task: str) -> dict[str, str]:
    """The last status while a task was the goal."""
    return [status for status in bag["/arm/status"].statuses() if status.get("task") == task][-1]


def test_touch_dig_and_weigh(tmp_path: Path) -> None:
    options = (str(HERE / "dig_run.yaml"), *PATIENT)
    bags = records(tmp_path, {name: ((*options, *layout), FOUR_THREADS) for name, layout in LAYOUTS.items()}, status=0)
    bag = bags["direct"]
    require_same(bag, bags["processes"])
    assert not list(judge_bag(bag)[0].lines())
    contacts = bag["/truth/contacts"].points()
    soil, force = contacts["soil"][:, TIP], contacts["force_z"][:, TIP]
    touching = contacts["sinkage"][:, TIP] > 0.0
    on_rock = touching & (soil == soil[touching][0])
    assert 10.0 <= force[on_rock].max() <= 30.0, "a guarded move stops within 20 N of its threshold"
    touched = said(bag, "guarded_move")
    assert touched["state"] == "reached" and float(touched["overshoot_m"]) < 2e-3
    # the dig: what the arm felt is what the ground gave, and the soil is in the scoop
    dug, in_soil = said(bag, "dig"), touching & ~on_rock
    assert dug["state"] == "reached"
    assert float(dug["peak_force_n"]) == pytest.approx(force[in_soil].max(), abs=3.0)
    across = np.hypot(contacts["force_x"][in_soil, TIP], contacts["force_y"][in_soil, TIP])
    assert float(dug["peak_drag_n"]) == pytest.approx(across.max(), abs=3.0)
    tool = [status for status in bag["/truth/loads"].statuses() if "tool carried_kg" in status]
    carried, taken = float(tool[-1]["tool carried_kg"]), float(tool[-1]["tool taken_m3"])
    assert taken == pytest.approx(0.06 * 0.06 * float(dug["depth_m"]), rel=0.25)
    assert taken == pytest.approx(float(tool[-1]["tool carried_m3"]) + float(tool[-1]["tool pushed_m3"]), rel=1e-6)
    # it hangs on the arm
    weighed = said(bag, "weigh")
    assert weighed["state"] == "reached"
    assert float(weighed["payload_kg"]) == pytest.approx(carried, abs=0.03)
    assert float(weighed["payload_by_wrist_kg"]) == pytest.approx(carried, abs=0.02)
    lid = bag["/joint_states"].joints()
    place = lid.index("tool_joint")
    assert lid.position[:, place].max() == pytest.approx(1.2, abs=0.01)
    assert lid.position[-1, place] == pytest.approx(0.0, abs=0.01)
