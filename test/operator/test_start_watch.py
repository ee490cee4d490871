"""A stack that is starting says for whom it waits, and one that runs or has gone is not starting."""

from sojourn_contract.heartbeat import READY, RUNNING, WAITING_TO_MATCH, Counters, heartbeat_message, status_message
from sojourn_operator.start_watch import LIFE_S, StartWatch


class Said:
    """A watch, its words, and a clock that is set by hand."""

    def __init__(self) -> None:
        self.words, self.now, self.held = list[str](), 100.0, list[str]()
        self.watch = StartWatch(lambda: self.held, self.words.append, lambda: self.now)

    def beat(self, role: str, state: str, detail: str = "", stamp: int = 0) -> None:
        self.watch.hear(heartbeat_message(role, state, stamp, Counters(), detail))


def test_nobody_is_not_starting() -> None:
    said = Said()
    said.watch.hear(status_message(0, "battery of somebody else", {"volts": "3"}))
    assert not said.watch.is_starting() and not said.words


def test_it_names_those_who_are_not_there_once_each_time_that_they_are_others() -> None:
    said = Said()
    said.beat("drive", WAITING_TO_MATCH, "no publisher of /joint_states (sensors); /odom is not heard by all of arm")
    said.beat("sensors", READY)
    for _ in range(3):
        assert said.watch.is_starting()
    said.beat("power", WAITING_TO_MATCH, "no publisher of /truth/electrical (plant); /drive/status is not heard by all")
    assert said.watch.is_starting()
    said.beat("drive", READY)
    assert said.watch.is_starting()
    assert said.words == [
        "the stack is starting: waiting for arm",
        "the stack is starting: waiting for arm, plant",
        "the stack is starting: waiting for plant",
    ]


def test_when_all_are_ready_the_plant_is_next() -> None:
    said = Said()
    said.beat("drive", READY)
    assert said.watch.is_starting() and said.words == ["the stack is starting: waiting for plant"]


def test_who_waits_and_does_not_say_for_whom_is_waited_for() -> None:
    said = Said()
    said.beat("arm", WAITING_TO_MATCH)
    assert said.watch.is_starting() and said.words == ["the stack is starting: waiting for arm"]


def test_a_stack_that_runs_or_says_nothing_more_is_not_starting() -> None:
    said = Said()
    said.beat("drive", READY)
    said.beat("drive", RUNNING, stamp=10**9)
    assert not said.watch.is_starting()
    said.beat("drive", READY)
    said.now += LIFE_S
    assert not said.watch.is_starting()


def test_before_its_first_heartbeat_a_stack_is_known_by_who_holds_its_roles() -> None:
    said = Said()
    said.held = ["plant", "drive"]
    assert said.watch.is_starting() and not said.words, "it may run, and be heard in a moment"
    said.now += 2.1
    assert said.watch.is_starting() and said.words == ["the stack is starting: waiting for drive, plant"]
    said.held = []
    assert not said.watch.is_starting()
    said.held = ["plant", "drive"]
    said.beat("plant", RUNNING, stamp=10**9)
    assert not said.watch.is_starting(), "it runs, and has no arm"
