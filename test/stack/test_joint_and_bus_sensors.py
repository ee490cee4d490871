"""Torque sensors, limit switches and currents of strings, in a whole run of an arm: what they say against the truth."""

import numpy as np
import pytest

from sojourn_bags.contract_version import check_contract
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_stack import run as direct

ROLES = ("plant", "sensors", "arm", "power", "operator", "recorder")
SCENARIO = "puma560_course"
BEFORE = 0.9
"""Far before the limits [rad], so that the arm operates some of its switches."""
EITHER_WAY = "{resolution: 0.01, noise: 0.01, offset: 0.02, minimum: -100.0, maximum: 100.0}"
CHANNEL = "{resolution: 0.01, noise: 0.01, offset: 0.02, minimum: 0.0, maximum: 100.0}"


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Bag:
    scenario = load_scenario(SCENARIO)
    joints = ", ".join(scenario.arm_joints)
    loads = ", ".join(load.name for load in scenario.power.loads)
    folder = tmp_path_factory.mktemp("arm") / "bag"
    sensors = (
        f"sensors.gauges={{kind: torque_sensor, joints: [{joints}], rated_torque: 200.0, noise: 1.0e-6, bits: 20}}",
        f"sensors.ends={{kind: limit_switches, joints: [{joints}], before: {BEFORE}, hysteresis: 0.02}}",
        f"sensors.motors={{kind: motor_sensor, joints: [{joints}], current: {EITHER_WAY}, voltage: {EITHER_WAY}}}",
        f"sensors.strings={{kind: string_currents, loads: [{loads}], current: {CHANNEL}}}",
    )
    direct.run(direct.RunSpec(SCENARIO, ROLES, (*sensors, "duration_limit_s=8.0"), bag=folder))
    return read_bag(folder)


def test_the_contract_is_kept(bag: Bag) -> None:
    check_contract(bag)
    report, _ = judge_bag(bag)
    assert not list(report.lines())
    assert {
        "/joint_torque/gauges",
        "/limit_switches/ends",
        "/currents/strings",
        "/motors/motors",
        "/truth/motors",
    } <= set(report.messages)


def test_torques_are_the_true_ones_within_noise(bag: Bag) -> None:
    told, true = bag["/joint_torque/gauges"].joints(), bag["/truth/joint_states"].joints()
    assert told.names
    for name in told.names:
        measured = told.effort[:, told.names.index(name)]
        truth = np.interp(
            bag["/joint_torque/gauges"].times, bag["/truth/joint_states"].times, true.effort[:, true.names.index(name)]
        )
        assert np.abs(measured - truth)[1:].max() < 5.0 * 200.0 * 1e-6 / 2e-3 + 0.01
    assert np.ptp(told.effort) > 1.0


def test_currents_are_powers_over_the_voltage(bag: Bag) -> None:
    told, truth = bag["/currents/strings"].statuses(), bag["/truth/loads"].statuses()
    volts = bag["/truth/electrical"].column("voltage")
    loads = [key.removeprefix("current ") for key in told[0] if key.startswith("current ")]
    assert loads and len(told) >= 40
    for load in loads:
        amps = np.array([float(each[f"current {load}"]) for each in told])
        true = np.array([float(each[f"power {load}"]) for each in truth])[: len(amps)] / volts[: len(amps)]
        assert abs(np.mean(amps - true)) < 4 * 0.02 + 0.01 and np.std(amps - true) < 0.03


def test_motors_draw_from_the_bus_what_current_and_voltage_say(bag: Bag) -> None:
    """Sum of u i over the arm's motors against the power of its load, which comes of torques, rates and heat.

    The one is that of an instant, the other the mean of a period: the same while the arm holds still.
    """
    scenario = load_scenario(SCENARIO)
    (load,) = scenario.machine.loads_of(scenario.arm_joints)
    truth = bag["/truth/motors"].statuses()
    of_motors = np.array(
        [sum(float(each[f"current {joint}"]) * float(each[f"voltage {joint}"]) for joint in scenario.arm_joints)
         for each in truth]
    )  # fmt: skip
    drawn = np.array([float(each[f"power {load}"]) for each in bag["/truth/loads"].statuses()])
    holds = np.flatnonzero(np.abs(np.diff(drawn)) < 0.01 * drawn[1:]) + 1
    assert len(holds) > 5 and drawn.max() > 5.0 * drawn[holds].max()
    np.testing.assert_allclose(of_motors[holds], drawn[holds], rtol=0.02)
    assert np.corrcoef(of_motors, drawn)[0, 1] > 0.9


def test_currents_and_voltages_of_motors_are_the_true_ones_within_noise(bag: Bag) -> None:
    told, truth = bag["/motors/motors"].statuses(), bag["/truth/motors"].statuses()
    names = [key for key in told[0] if key.startswith(("current ", "voltage "))]
    assert len(names) == 2 * len(load_scenario(SCENARIO).arm_joints)
    for name in names:
        off = np.array([float(one[name]) - float(other[name]) for one, other in zip(told, truth, strict=False)])
        assert abs(off.mean()) < 4 * 0.02 + 0.01 and 0.005 < off.std() < 0.02


def test_switches_are_closed_where_the_joint_is_near_its_limit(bag: Bag) -> None:
    limits, true, words = load_scenario(SCENARIO).urdf.joints, bag["/truth/joint_states"].joints(), set[str]()
    messages = bag["/limit_switches/ends"]
    for name in true.names:
        angles = np.interp(messages.times, bag["/truth/joint_states"].times, true.position[:, true.names.index(name)])
        for end, beyond in (("lower", limits[name].lower - angles), ("upper", angles - limits[name].upper)):
            for into, said in zip(beyond.tolist(), messages.statuses(), strict=True):
                contact = said[f"{end} {name}"]
                words.add(contact)
                assert contact in ("open", "closed")
                assert contact == "closed" or into < -BEFORE + 1e-6
                assert contact == "open" or into > -BEFORE - 0.02 - 1e-6
    assert words == {"open", "closed"}


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("sensors.a={kind: torque_sensor, joints: [shouldr], rated_torque: 9.0}", ["a.joints", "no joint of the URDF"]),
        ("sensors.a={kind: limit_switches, joints: [wheel_front_left_joint], before: 0.1, hysteresis: 0.0}",
         ["a.joints", "whose travel has ends"]),
        (f"sensors.a={{kind: motor_sensor, joints: [nobody_joint], current: {CHANNEL}}}", ["motor of ours"]),
        ("sensors.a={kind: motor_sensor, joints: [joint1]}", ["at least one"]),
        (f"sensors.a={{kind: string_currents, loads: [imu, computr], current: {CHANNEL}}}",
         ["a.loads[1]", "no load of a bus with a store", "did you mean computer"]),
    ],
)  # fmt: skip
def test_parts_that_are_not_there_are_refused(override: str, words: list[str]) -> None:
    with pytest.raises(ConfigError) as refused:
        load_scenario("flat_drive", [override])
    for word in words:
        assert word in str(refused.value), str(refused.value)
