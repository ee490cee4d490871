"""Rovers find their way round a stone by their own cameras, with what follows of a machine that carries them."""

from pathlib import Path

import numpy as np
import pytest
from programs import PATIENT, Program, with_long

from sojourn_bags.reading import read_bag

HERE = Path(__file__).parent
STONE = (2.7, 0.05)


@pytest.mark.parametrize("rover", with_long(["lunokhod", "micro", "skid", "tracked"], {"lunokhod", "skid", "tracked"}))
def test_it_goes_round_a_stone_that_only_its_cameras_tell_of(rover: str, tmp_path: Path, domain: int) -> None:
    given = (HERE / "seen_stone.yaml", "--direct", "--set", f"machine={rover}", "--run-dir", tmp_path / "run")
    program = Program("start", [str(one) for one in (*given, *PATIENT, "--domain", domain)], tmp_path / "log")
    try:
        assert program.wait() == 0, program.text
    finally:
        program.end()
    bag = read_bag(tmp_path / "run")
    x, y = (bag["/truth/odom"].column(f"pose.pose.position.{axis}") for axis in "xy")
    assert np.hypot(x[-1] - 5.0, y[-1]) < 0.4
    assert np.hypot(x - STONE[0], y - STONE[1]).min() > 0.3, "its middle has gone round"
    last = bag["/drive/status"].statuses()[-1]
    assert float(last["detours"]) >= 1.0 and last["state"] == "reached"
