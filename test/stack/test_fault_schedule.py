"""A schedule of faults in a whole run: they come and go when they should, are in the bag, and part of the state."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from sojourn_bags.contract_version import check_own_contract
from sojourn_bags.reading import read_bag
from sojourn_config.scenario import load_scenario
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.fault_messages import FaultEvent, fault_message, read_fault
from sojourn_contract.heartbeat import status_message
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topics import ROLES, topic
from sojourn_contract.values import Odometry
from sojourn_machine.fault_choice import read_fault_words
from sojourn_operator.fault_schedule import FaultSchedule, ScheduleState, SeenRun
from sojourn_plant.app import PlantApp
from sojourn_sensors.app import SensorsApp
from sojourn_stack.apps import make_apps
from sojourn_stack.checkpoint import load, save
from sojourn_stack.recorder import onset_of
from sojourn_stack.run import RunSpec, run
from sojourn_stack.stack import Said, Stack, StackState

WHEEL, STEERING = "wheel_front_left_joint", "steer_front_left_joint"
PARTICIPANTS = tuple(role for role in ROLES if role != "recorder")
SCHEDULE = (
    f"faults=[{{kind: motor_dead, joint: {WHEEL}, at: 0.5, until: 1.0}},"
    f"{{kind: joint_seized, joint: {STEERING}, when: {{drive: moving}}, lasts: 0.5}},"
    "{kind: sensor, sensor: imu, of: angular_velocity, bias: 0.5, at: 0.4, lasts: 0.5}]"
)


def stepped(stack: Stack, state: StackState, periods: int) -> tuple[StackState, list[Said]]:
    told: list[Said] = []
    for _ in range(periods):
        state, said = stack.step(state)
        told += [(row, message) for row, message in said if row.name in ("/faults", "/imu/data", "/truth/odom")]
    return state, told


@pytest.fixture(scope="module")
def stack() -> Stack:
    scenario = load_scenario("flat_drive", [SCHEDULE])
    return Stack(make_apps(scenario, PARTICIPANTS), PARTICIPANTS)


def test_faults_come_and_go_at_their_times(stack: Stack) -> None:
    state, _ = stack.begin()
    seen: dict[str, list[int]] = {}
    for _ in range(120):
        state, _ = stack.step(state)
        for one in state.roles["plant"].app.faults:
            seen.setdefault(one.name, []).append(state.period - 1)
        for name in state.roles["sensors"].app.faulty:
            seen.setdefault(name, []).append(state.period - 1)
    spans = {name: (periods[0], periods[-1]) for name, periods in seen.items()}
    assert spans[f"motor_dead {WHEEL}"] == (25, 49)
    assert spans["imu"] == (20, 44)
    # the drive says that it moves in its status of 1.0 s, which is seen then and acts as late as a goal would
    begins, ends = spans[f"joint_seized {STEERING}"]
    assert (begins, ends - begins) == (55, 24)
    assert not any(one.refused for one in state.roles.values())


def test_a_state_within_a_fault_goes_on_as_the_run_does(stack: Stack, tmp_path: Path) -> None:
    state, _ = stepped(stack, stack.begin()[0], 40)
    save(state, tmp_path / "kept")
    again = load(tmp_path / "kept")
    assert again.roles["plant"].app.faults == state.roles["plant"].app.faults != ()
    through, told = stepped(stack, state, 40)
    resumed, told_again = stepped(stack, again, 40)
    assert [row.name for row, _ in told] == [row.name for row, _ in told_again]
    assert through.roles["plant"].app.machine.configuration.tolist() == (
        resumed.roles["plant"].app.machine.configuration.tolist()
    )


def test_a_schedule_is_in_the_bag(tmp_path: Path) -> None:
    fault = f"{{kind: motor_weak, name: tired, joint: {WHEEL}, part: 0.5, when: {{distance: 0.02}}}}"
    run(RunSpec("flat_drive", tuple(ROLES), (f"faults=[{fault}]", "duration_limit_s=4.0"), tmp_path / "bag"))
    (said,) = read_bag(tmp_path / "bag")["/faults"].statuses()
    expected = {"name": "tired", "state": "present", "kind": "motor_weak", "joint": WHEEL, "part": "0.5"}
    assert {key: said[key] for key in expected} == expected


def test_a_bag_whose_sensors_wait_for_the_operator_is_one_of_our_contract(tmp_path: Path) -> None:
    fault = "faults=[{kind: sensor, sensor: imu, stuck: true, at: 0.3}]"
    run(RunSpec("flat_drive", tuple(ROLES), (fault, "duration_limit_s=0.5"), tmp_path / "bag"))
    assert check_own_contract(read_bag(tmp_path / "bag"))


def test_the_distance_counts_from_the_start_of_the_run_in_a_branch_too() -> None:
    """In a run without faults it was not counted: a fault of 15 m came after 35."""
    words = f"faults=[{{kind: motor_dead, joint: {WHEEL}, when: {{distance: 15.0}}}}]"
    (fault,) = load_scenario("flat_drive", [words]).config.faults
    state, branch = ScheduleState(), FaultSchedule([fault], seed=1)
    truth = Odometry(0, "map", "base_link", np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3), np.zeros(3))
    for second in range(1, 12):
        at = truth._replace(position=np.array([float(second), 0.0, 0.0]))
        state, _ = FaultSchedule([], seed=1).look(state, SeenRun(second * NANOSECONDS, 0, {}, at))
    assert state.distance == 10.0
    for second in range(12, 30):
        at = truth._replace(position=np.array([float(second), 0.0, 0.0]))
        state, said = branch.look(state, SeenRun(second * NANOSECONDS, 0, {}, at))
        if said:
            break
    assert second == 16


BY_HAND = {
    "plant": {"kind": "motor_weak", "joint": WHEEL, "part": "0.5"},
    "sensors": {"kind": "sensor", "sensor": "imu", "stuck": "true"},
}


@pytest.mark.parametrize(("role", "begin"), [("plant", 0.0), ("sensors", 0.06)])
@pytest.mark.parametrize(
    "words",
    ["", "{kind: message_lost, topic: /drive_command, at: 9.0}, {kind: node_restarted, node: sensors, at: 9.0}"],
)
def test_a_fault_that_was_sent_by_hand_is_told_of_in_what_goes_on(role: str, begin: float, words: str) -> None:
    """It acted on, and stood neither in the verdict nor in the report."""
    in_table = "sensors.imu.faults={worn: {bias: 0.001, of: angular_velocity}}"
    scenario = load_scenario("flat_drive", [f"faults=[{words}]", in_table])
    stack = Stack(make_apps(scenario, PARTICIPANTS), PARTICIPANTS)
    state, _ = stepped(stack, stack.begin()[0], 2)
    fault = read_fault_words(BY_HAND[role])
    state = stack.hearing(state, role, [(topic("/faults"), fault_message(0, FaultEvent("by hand", fault, True)))])
    state, _ = stepped(stack, state, 5)
    assert onset_of(state, scenario).faults == {"by hand": (begin, None)}


def test_a_fault_whose_end_is_past_when_its_event_comes_never_comes() -> None:
    """It came for one control period."""
    (fault,) = load_scenario(
        "flat_drive", [f"faults=[{{kind: motor_dead, joint: {WHEEL}, when: {{after_step: 1}}, until: 2.0}}]"]
    ).config.faults
    schedule = FaultSchedule([fault], seed=1)
    truth = Odometry(0, "map", "base_link", np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3), np.zeros(3))
    state, said = schedule.look(ScheduleState(), SeenRun(3 * NANOSECONDS, 1, {}, truth))
    later, said_later = schedule.look(state, SeenRun(4 * NANOSECONDS, 1, {}, truth))
    assert said == said_later == [] and not later.begun
    assert schedule.quiet_until(later) == math.inf
    in_time, said = schedule.look(ScheduleState(), SeenRun(NANOSECONDS, 1, {}, truth))
    assert len(said) == 1 and fault.called in in_time.begun


def test_a_message_says_a_fault_and_is_read_again() -> None:
    for words in (
        {"kind": "panel_stuck", "source": "array", "normal": [0.0, 1.0, 0.0]},
        {"kind": "switch_stuck", "load": "cameras", "where": "on"},
        {"kind": "sensor", "sensor": "imu", "of": "angular_velocity", "bias": [0.1, 0.0, 0.0]},
    ):
        event = FaultEvent("mine", read_fault_words(words), comes=True)
        assert read_fault(fault_message(20, event)) == event


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"kind": "motor_ded", "joint": WHEEL}, "did you mean motor_dead"),
        ({"kind": "motor_dead"}, "joint = .*Field required"),
        ({"kind": "motor_dead", "joint": "wheel_front_lef_joint"}, "did you mean wheel_front_left_joint"),
        ({"kind": "motor_dead", "joint": WHEEL, "part": "0.5"}, "part = 0.5: allowed is no such word"),
        ({"kind": "motor_dead", "joint": WHEEL, "state": "perhaps"}, "allowed is present or gone"),
        ({"kind": "sensor", "sensor": "imu", "dust": "0.5"}, "no dust: it has no lens"),
        ({"kind": "sensor", "sensor": "imuu", "stuck": "true"}, "did you mean imu"),
    ],
)
def test_messages_that_nobody_can_act_on_are_refused(
    words: dict[str, str], message: str, judges: Sequence[PlantApp | SensorsApp]
) -> None:
    found = []
    for app in judges:
        try:
            app.check(topic("/faults"), status_message(0, "", words))
        except RefusedMessageError as refusal:
            found.append(refusal)
    with pytest.raises(RefusedMessageError, match=message):
        raise found[0]


@pytest.fixture(scope="module")
def judges() -> Sequence[PlantApp | SensorsApp]:
    scenario = load_scenario("flat_drive")
    return PlantApp(scenario), SensorsApp(scenario)
