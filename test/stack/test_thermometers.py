"""Thermometers on parts of a machine, in whole runs: what they say against the truth, and machines without the part."""

import math
from pathlib import Path

import numpy as np
import pytest

from sojourn_bags.contract_version import check_contract
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.app import Period
from sojourn_contract.codecs.ros_library import message_of
from sojourn_contract.heartbeat import status_message
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_plant.app import PlantApp
from sojourn_sensors.app import SensorsApp
from sojourn_stack import run as direct

ROLES = ("plant", "sensors", "drive", "arm", "power", "operator", "recorder")
NAMES = ("battery_cells", "box_wall", "shell_wall", "radiator_plate")
SHORT = ("steps=[{wait_s: 12.0}]",)


def run(folder: Path, *overrides: str) -> Bag:
    direct.run(direct.RunSpec("lunar_night", ROLES, (*SHORT, *overrides), bag=folder))
    return read_bag(folder)


@pytest.fixture(scope="module")
def night(tmp_path_factory: pytest.TempPathFactory) -> Bag:
    return run(tmp_path_factory.mktemp("night") / "bag")


def node_temperatures(bag: Bag, node: str) -> list[float]:
    """As the plant has them [degC]."""
    return [float(values[f"temperature {node}"]) - 273.15 for values in bag["/truth/loads"].statuses()]


def test_each_tells_its_part_within_what_it_says_of_its_error(night: Bag) -> None:
    parts = {"box_wall": "box", "shell_wall": "shell", "radiator_plate": "radiator"}
    truths = {name: float(np.mean(node_temperatures(night, node))) for name, node in parts.items()}
    truths["battery_cells"] = float(night["/truth/electrical"].column("temperature").mean())
    for name in NAMES:
        told = night[f"/temperature/{name}"]
        assert len(told) >= 12
        error = told.column("temperature").mean() - truths[name]
        assert 0.0 < abs(error) < 4.0 * float(np.sqrt(told.column("variance").mean())) < 0.5


def test_the_contract_is_kept(night: Bag) -> None:
    check_contract(night)
    report, _ = judge_bag(night)
    assert not list(report.lines()) and {f"/temperature/{name}" for name in NAMES} <= set(report.messages)


def test_one_more_changes_no_number_of_another(night: Bag, tmp_path: Path) -> None:
    more = run(tmp_path / "bag", "sensors.another={kind: platinum_thermometer, node: box, tolerance: B}")
    for name in (*(f"/temperature/{name}" for name in NAMES), "/imu/data", "/bus/state"):
        field = "temperature" if "imu" not in name else "linear_acceleration.x"
        assert np.array_equal(more[name].column(field), night[name].column(field)), name
    told = more["/temperature/another"].column("temperature")
    assert not np.array_equal(told, night["/temperature/box_wall"].column("temperature"))


def test_without_power_it_says_that_it_does_not_measure() -> None:
    """Its element goes on following the box, so that it tells the truth as soon as it is fed again."""
    scenario = load_scenario("lunar_night")
    app, plant = SensorsApp.of(scenario), PlantApp.of(scenario)
    state, told = app.initial_state(), []
    truth = dict(plant.first_messages(plant.initial_state(), CONTROL_PERIOD_NS))
    for second, (power, box) in enumerate([(20.0, 290.0), (0.0, 290.0), (0.0, 300.0), (20.0, 300.0)], start=1):
        stamp = second * 50 * CONTROL_PERIOD_NS
        values = {"power computer": f"{power}", "temperature box": f"{box}"}
        truth["/truth/loads"] = status_message(stamp, "loads", values)
        state, answer = app.step(state, Period(stamp, truth))
        assert not answer.refusals
        (said,) = (message for name, message in answer.messages if name == "/temperature/box_wall")
        told.append(message_of(said).temperature)
    assert np.isnan(told[1:3]).all() and told[0] == pytest.approx(16.85, abs=0.4)
    lag = 10.0 * math.exp(-2.0 / 5.0)  # two seconds of its time constant after the step
    assert told[3] == pytest.approx(26.85 - lag, abs=0.4)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("sensors.box_wall.node=bx", ["box_wall.node", "no node of the machine's heat", "did you mean box"]),
        ("sensors.battery_cells.store=batery", ["battery_cells.store", "is no store", "did you mean battery"]),
        ("sensors.box_wall.store=battery", ["node and store given", "allowed is one of node, store, motor"]),
        ("sensors.a={kind: platinum_thermometer}", ["nothing given", "allowed is one of node, store, motor"]),
        (
            "sensors.a={kind: platinum_thermometer, motor: wheel_front_left_joint}",
            ["a.motor", "motor's heat is known", "thermal"],
        ),
    ],
)
def test_a_part_that_is_not_there_is_refused_before_the_run(override: str, words: list[str]) -> None:
    with pytest.raises(ConfigError) as refused:
        load_scenario("lunar_night", [override])
    for word in words:
        assert word in str(refused.value), str(refused.value)


def test_a_machine_without_heat_has_no_node() -> None:
    with pytest.raises(ConfigError, match=r"a\.node = 'box': is no node .* thermal\.yaml"):
        load_scenario("flat_drive", ["sensors.a={kind: platinum_thermometer, node: box}"])


def test_a_motor_whose_heat_is_known_has_a_warm_winding(tmp_path: Path) -> None:
    scenario = load_scenario("srms_course", ["steps=[]"])
    joint = scenario.machine.drives[0].joints[0]
    sensor = f"sensors.winding={{kind: platinum_thermometer, motor: {joint}, tolerance: none}}"
    steps = "steps=[{arm_joints: {name: unfold}, timeout_s: 20.0}]"
    roles = ("plant", "sensors", "arm", "power", "operator", "recorder")
    direct.run(direct.RunSpec("srms_course", roles, (sensor, steps), bag=tmp_path / "bag"))
    bag = read_bag(tmp_path / "bag")
    truth = np.array([float(each[f"winding {joint}"]) for each in bag["/truth/loads"].statuses()]) - 273.15
    told = bag["/temperature/winding"].column("temperature")
    assert truth[-1] > truth[0] + 0.01, "it has worked"
    assert told[-1] == pytest.approx(truth[-1], abs=0.1) and told[1] == pytest.approx(truth[1], abs=0.1)
