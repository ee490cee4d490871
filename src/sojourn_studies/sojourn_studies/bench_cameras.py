"""Bench of what sees: a stereo pair with its depth, a lidar's scan, and what a pair a second leaves of the loop.

The pair is the navigation cameras' on the explorer's mast, 640 x 480 pixels; the lidar on the same link has 940 x 32
beams all round. Both see level ground or the relief of the demonstration from where its run begins. For the loop two
stacks with all roles and a recorder each, one with the pair and one without, go in turns in one process, a second of
simulated time each, so that what the computer does besides falls on both alike: standing on level ground, and on the
demonstration's drive, without and with the odometry that the drive makes of the images. Of a reading the time of one
core counts, on which all threads run: two cores that are the two halves of one take each other's time. Of the loop that
of the wall counts, as images are made beside the loop where there is a second core.
"""

import os
import statistics
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import yaml

from sojourn_config.collector import settle_collector
from sojourn_config.paths import config_folder
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import CONTROL_PERIOD_NS, CONTROL_PERIOD_S
from sojourn_contract.unfinished_image import finished
from sojourn_contract.values import JointState, Odometry
from sojourn_plant.start import build_plant
from sojourn_sensors.sensor import SensorSite, Truth
from sojourn_studies.timed_loop import TURN, TimedLoop

MACHINE = "explorer_cameras"
LEVEL, RELIEF = "flat_drive", "lunar_sample"
PAIR = {"kind": "stereo_camera", "extends": "mer_navcam", "lens": {"columns": 640, "rows": 480}}
LIDAR = {
    "kind": "lidar", "columns": 940, "rows": 32, "horizontal_view_deg": 360.0, "vertical_view_deg": 40.0,
    "nearest": 0.5, "range": 100.0, "noise": 0.02, "resolution": 0.002, "dropped": 0.01,
}  # fmt: skip
MAST = {
    "joints": ["mast_pan_joint", "mast_tilt_joint"], "encoder": {"bits": 14, "side": "output", "rate_window": 5},
    "effort_resolution": 0.05, "effort_noise": 0.05,
}  # fmt: skip
ODOMETRY = {"visual_odometry": {"extends": "visual_odometry", "camera": "navcam"}}
STANDING = ("steps=[]", "duration_limit_s=3000.0")
WARM_READINGS, WARM_TURNS = 3, 3
AHEAD = TURN - 5
"""Periods before the first turn: a pair is taken soon after a turn begins, so that it is made in the same."""
PAIR_MS, SCAN_MS = "stereo pair 640 x 480 with depth, {} [ms]", "lidar of 30 080 beams, {} [ms]"
KEPT = "loop with a pair a second keeps, {} [%]"
TARGETS = {
    **{PAIR_MS.format(ground): ("<=", 60.0) for ground in ("level ground", "relief")},
    **{SCAN_MS.format(ground): ("<=", 15.0) for ground in ("level ground", "relief")},
    **{KEPT.format(way): (">=", 80.0) for way in ("standing on level ground", "driving over relief")},
}


def write_machine(folder: Path, name: str, seeing: dict[str, object], odometry: bool = False) -> Path:
    """A folder of the explorer with a mast and only these sensors on it, in an existing one; returns its path."""
    made, machines = folder / name, config_folder().resolve() / "machines"
    made.mkdir()
    tables: dict[str, dict[str, object]] = {
        "machine": {"extends": str(machines / MACHINE / "machine.yaml")},
        "power": {"extends": str(machines / MACHINE / "power.yaml")},
        "flight": {"extends": str(machines / "explorer" / "flight.yaml")} | ({"drive": ODOMETRY} if odometry else {}),
        "sensors": {"extends": str(machines / "explorer" / "sensors.yaml"), "joint_groups": {"mast": MAST}}
        | {sensor: {"link": "navcam_link", **params} for sensor, params in seeing.items()},  # type: ignore[dict-item]
    }
    for file, table in tables.items():
        (made / f"{file}.yaml").write_text(yaml.safe_dump(table, sort_keys=False), "utf-8")
    return made


def bench_cameras(readings: int, turns: int) -> dict[str, float]:
    """What a pair and a scan take, and the loop's speed with a pair a second over that without.

    Args:
        readings: of each sensor that count. turns: of each loop that count.
    """
    with tempfile.TemporaryDirectory(prefix="sojourn-bench-") as place:
        folder = Path(place)
        seeing = write_machine(folder, "seeing", {"navcam": PAIR, "scanner": LIDAR})
        blind = write_machine(folder, "blind", {})
        pair = write_machine(folder, "pair", {"navcam": PAIR})
        flown = write_machine(folder, "flown", {"navcam": PAIR}, odometry=True)
        settle_collector()
        found = {}
        for ground, scenario in (("level ground", LEVEL), ("relief", RELIEF)):
            loaded = load_scenario(scenario, [f"machine={seeing}"])
            found[PAIR_MS.format(ground)] = reading_ms(loaded, "navcam", readings)
            found[SCAN_MS.format(ground)] = reading_ms(loaded, "scanner", readings)
        standing = compare((blind, pair), LEVEL, STANDING, turns)
        driving = compare((blind, pair, flown), RELIEF, (), turns)
    return {
        **found,
        "loop without cameras, standing on level ground, a period [us]": standing[0] / TURN * 1e6,
        KEPT.format("standing on level ground"): 100.0 * standing[0] / standing[1],
        "loop without cameras, driving over relief, a period [us]": driving[0] / TURN * 1e6,
        KEPT.format("driving over relief"): 100.0 * driving[0] / driving[1],
        KEPT.format("driving over relief, odometry of images"): 100.0 * driving[0] / driving[2],
    }


def reading_ms(scenario: LoadedScenario, name: str, count: int) -> float:
    """Milliseconds of one core that one reading of a sensor takes at the start of a scenario: the median."""
    sensor = scenario.sensors.sensors[name].sensor(name, SensorSite(scenario, table_of(scenario)))
    model, state = build_plant(scenario)
    still, joints = np.zeros(3), model.joints.names
    pose = Odometry(
        CONTROL_PERIOD_NS, "map", "base_link", state.configuration[:3], state.configuration[3:7], still, still
    )
    rest = np.zeros(len(joints))
    truth = Truth(CONTROL_PERIOD_NS, pose, JointState(CONTROL_PERIOD_NS, tuple(joints), rest, rest, rest), {})
    memory, taken = sensor.initial_state(truth), []
    for _ in range(WARM_READINGS):
        finished(sensor.step(memory, truth, CONTROL_PERIOD_S)[1])
    with _on_one_core():
        for _ in range(count):
            begin = time.process_time()  # of all threads
            finished(sensor.step(memory, truth, CONTROL_PERIOD_S)[1])
            taken.append(time.process_time() - begin)
    return 1e3 * statistics.median(taken)


@contextmanager
def _on_one_core() -> Iterator[None]:
    """Keep all threads of this process on one core."""
    cores = os.sched_getaffinity(0)
    try:
        _stay_on({min(cores)})
        yield
    finally:
        _stay_on(cores)


def _stay_on(cores: set[int]) -> None:
    for thread in os.listdir("/proc/self/task"):
        os.sched_setaffinity(int(thread), cores)


def compare(machines: Sequence[Path], scenario: str, overrides: Sequence[str], turns: int) -> list[float]:
    """Seconds of wall time that a second of simulated time takes on each machine, in turns: the median."""
    with tempfile.TemporaryDirectory(prefix="sojourn-bench-") as folder:
        loops = [
            TimedLoop(
                scenario, (f"machine={machine}", *overrides), time.perf_counter, Path(folder) / machine.name, AHEAD
            )
            for machine in machines
        ]
        taken: list[list[float]] = [[] for _ in loops]
        for number in range(WARM_TURNS + turns):
            for place in sorted(range(len(loops)), reverse=bool(number % 2)):
                seconds, _ = loops[place].turn()
                if number >= WARM_TURNS:
                    taken[place].append(seconds)
        for loop in loops:
            loop.end()
    return [statistics.median(times) for times in taken]
