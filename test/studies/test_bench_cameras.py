"""What images cost: the machines that are measured, and that each figure is one."""

import math
from pathlib import Path

from sojourn_config.scenario import load_scenario
from sojourn_studies import bench_cameras, bench_parts


def test_machines_differ_in_what_sees_alone(tmp_path: Path) -> None:
    seeing = bench_cameras.write_machine(tmp_path, "pair", {"navcam": bench_cameras.PAIR}, odometry=True)
    blind = bench_cameras.write_machine(tmp_path, "blind", {})
    one, other = (load_scenario("flat_drive", [f"machine={machine}"]) for machine in (seeing, blind))
    assert set(one.sensors.sensors) - set(other.sensors.sensors) == {"navcam"}
    assert set(other.sensors.sensors) <= set(one.sensors.sensors)
    navcam = one.sensors.sensors["navcam"]
    assert (navcam.lens.columns, navcam.lens.rows, navcam.timing) == (640, 480, None)
    assert one.machine == other.machine


def test_every_figure_with_a_target_is_measured() -> None:
    found = bench_cameras.bench_cameras(1, 1)
    assert set(bench_cameras.TARGETS) <= set(found) and "cameras" in bench_parts.PARTS
    assert all(math.isfinite(value) and value > 0.0 for value in found.values())
