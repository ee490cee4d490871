"""Whether a fault showed as it should: detected, missed, or a false alarm; from bags made for it."""

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sojourn_bags.detection import judge_faults, sentence
from sojourn_bags.onset import Onset, faults_before
from sojourn_config.errors import ConfigError
from sojourn_machine.fault_choice import FaultChoice, read_fault_words
from sojourn_operator.scenario_steps import prepare_scenario

EXPECT = {"topic": "/drive/status", "field": "failed_motors", "says": "front_left", "within": 5.0}
WORDS = {"kind": "motor_dead", "name": "dead", "joint": "wheel_front_left_joint", "at": 10.0}


def fault(**more: Any) -> FaultChoice:
    return read_fault_words({**WORDS, **more})


class Topics(dict[str, Any]):
    """Of a bag, and what it says of its run."""

    records: Mapping[str, Mapping[str, str]] = {}


def messages(rows: list[tuple[float, dict[str, str]]]) -> Any:
    return SimpleNamespace(times=np.array([at for at, _ in rows]), statuses=lambda: [values for _, values in rows])


def bag(
    came: list[tuple[float, str]], said: list[tuple[float, str]], name: str = "dead", end: float = 60.0, **run: str
) -> Any:
    """As `Bag` answers: /faults with (time, state), /drive/status with (time, failed_motors), the clock."""

    topics = Topics({"/drive/status": messages([(at, {"name": "drive", "failed_motors": text}) for at, text in said])})
    topics["/clock"] = messages([(end, {})])
    topics.records = {"sojourn_run": run}
    if came:
        topics["/faults"] = messages([(at, {"name": name, "state": state, "kind": "motor_dead"}) for at, state in came])
    return topics


@pytest.mark.parametrize(
    ("came", "said", "outcome", "after"),
    [
        ([(10.0, "present")], [(9.0, ""), (12.0, "drive of front_left")], "detected", 2.0),
        ([(10.0, "present"), (14.0, "gone")], [(15.0, "drive of front_left")], "detected", 5.0),
        ([(10.0, "present")], [(15.5, "drive of front_left")], "missed", 5.5),
        ([(10.0, "present")], [(15.5, "drive of rear_left")], "missed", None),
        ([(10.0, "present")], [(4.0, "drive of front_left"), (12.0, "drive of front_left")], "false alarm", 6.0),
        ([], [(4.0, "drive of front_left")], "false alarm", None),
        ([], [(4.0, "")], "did not come", None),
    ],
)
def test_what_became_of_a_fault(
    came: list[tuple[float, str]], said: list[tuple[float, str]], outcome: str, after: float | None
) -> None:
    (result,) = judge_faults(bag(came, said), [fault(expect=EXPECT)])
    assert (result.outcome, result.after_s) == (outcome, after)
    assert result.good == (outcome == "detected")
    assert result.begin_s == (10.0 if came else None)
    assert result.end_s == (14.0 if len(came) == 2 else None)


def test_a_fault_of_which_nobody_says_how_it_shows_is_not_judged() -> None:
    (planned,) = judge_faults(bag([(10.0, "present")], []), [fault()])
    (by_hand,) = judge_faults(bag([(10.0, "present")], [], "by hand"), [])
    assert planned.outcome == by_hand.outcome == "not judged"
    assert by_hand.kind == "motor_dead"
    assert planned.good
    assert sentence([planned, by_hand]) == ""


@pytest.mark.parametrize(
    ("end", "said", "outcome", "words"),
    [
        (10.6, [(10.2, "")], "not judged", "not judged: the record ended 0.6 s after it came"),
        (14.9, [], "not judged", "not judged: the record ended 4.9 s after it came"),
        (10.6, [(10.5, "front_left")], "detected", "detected in 0.5 s"),
        (10.6, [(9.0, "front_left")], "false alarm", "false alarm: 'front_left' in failed_motors"),
        (15.0, [(10.2, "")], "missed", "missed: 'front_left' in failed_motors"),
        (15.5, [(15.4, "front_left")], "missed", "missed: 'front_left' in failed_motors"),
    ],
)
def test_no_fault_is_missed_whose_time_the_record_does_not_hold(
    end: float, said: list[tuple[float, str]], outcome: str, words: str
) -> None:
    (result,) = judge_faults(bag([(10.0, "present")], said, end=end), [fault(expect=EXPECT)])
    assert result.outcome == outcome and result.words.startswith(words)
    assert result.good == (outcome in ("not judged", "detected"))
    assert ("missed" in sentence([result])) == (outcome == "missed")
    assert result.as_data()["begin_s"] == 10.0


def test_a_fault_that_comes_again_has_not_gone() -> None:
    coming = [(10.0, "present"), (14.0, "gone"), (20.0, "present")]
    (again,) = judge_faults(bag(coming, []), [])
    assert (again.begin_s, again.end_s) == (10.0, None)
    (gone_again,) = judge_faults(bag([*coming, (23.0, "gone")], []), [])
    assert (gone_again.begin_s, gone_again.end_s) == (10.0, 23.0)


def beat(at: float, faults: str, refusals: int, role: str = "plant") -> tuple[float, dict[str, str]]:
    told = {"refused /faults": str(refusals), "last refusal": "/faults.joint = nope"} if refusals else {}
    return at, {"name": role, "state": "running", "faults": faults, **told}


REFUSED_AT_10 = [(10.0, "present")]
QUIET = [beat(at, "", 0) for at in (10.5, 11.5, 12.5)]
OF_ONE = [beat(at, "", 1) for at in (10.5, 11.5, 12.5)]


@pytest.mark.parametrize(
    ("came", "beats", "outcome", "begin"),
    [
        (REFUSED_AT_10, [beat(9.5, "", 0), beat(10.5, "", 1)], "refused", None),
        (REFUSED_AT_10, [beat(9.5, "", 2), beat(10.5, "other", 2), beat(11.5, "other", 3)], "refused", None),
        (REFUSED_AT_10, [beat(9.5, "", 1), beat(10.5, "dead", 1)], "not judged", 10.0),
        (REFUSED_AT_10, [beat(9.5, "", 0), beat(10.5, "other, dead", 1)], "not judged", 10.0),
        (REFUSED_AT_10, [beat(9.5, "", 0), beat(10.5, "", 1), beat(10.5, "dead", 0, "sensors")], "not judged", 10.0),
        (REFUSED_AT_10, [beat(9.5, "", 0), *QUIET, beat(30.5, "", 1)], "not judged", 10.0),
        (REFUSED_AT_10, [beat(10.5, "", 4)], "not judged", 10.0),
        (REFUSED_AT_10, [], "not judged", 10.0),
        ([(10.0, "present"), (20.0, "present")], [beat(9.5, "", 0), *OF_ONE, beat(20.5, "dead", 1)],
         "not judged", 20.0),
        ([(10.0, "present"), (20.0, "present")], [beat(9.5, "", 0), beat(10.5, "dead", 0), beat(20.5, "dead", 1)],
         "not judged", 10.0),
    ],
)  # fmt: skip
def test_a_fault_that_the_plant_refused_has_not_come(
    came: list[tuple[float, str]], beats: list[tuple[float, dict[str, str]]], outcome: str, begin: float | None
) -> None:
    recorded = bag(came, [])
    recorded["/diagnostics"] = messages(beats)
    (by_hand,) = judge_faults(recorded, [])
    assert (by_hand.outcome, by_hand.begin_s, by_hand.kind) == (outcome, begin, "motor_dead")
    assert by_hand.good and sentence([by_hand]) == ""
    assert by_hand.words == ("refused: /faults.joint = nope" if outcome == "refused" else "not judged")
    (planned,) = judge_faults(recorded, [fault(expect=EXPECT)])
    assert planned.outcome == ("did not come" if outcome == "refused" else "missed")


def test_the_verdict_names_what_was_not_detected() -> None:
    results = judge_faults(bag([(10.0, "present")], []), [fault(expect=EXPECT)])
    assert sentence(results).startswith("0 of 1 faults were detected: dead: missed: 'front_left' in failed_motors")
    found = judge_faults(bag([(10.0, "present")], [(11.5, "front_left")]), [fault(expect=EXPECT)])
    assert sentence(found) == "1 of 1 faults were detected."
    assert found[0].words == "detected in 1.5 s"


@pytest.mark.parametrize(
    ("said", "outcome", "after"),
    [
        ([(12.0, ""), (13.0, "front_left")], "detected", 3.0),
        ([(12.0, "front_left")], "came before this record", None),
        ([(12.0, ""), (19.0, "front_left")], "came before this record", None),
        ([(12.0, "")], "came before this record", None),
    ],
)
def test_a_fault_that_came_before_a_bag_began_is_told_as_such(
    said: list[tuple[float, str]], outcome: str, after: float | None
) -> None:
    before = Onset(period=551, faults={"dead": (10.0, None)}).record()
    (result,) = judge_faults(bag([], said, **before), [fault(expect=EXPECT)])
    assert (result.outcome, result.after_s, result.begin_s, result.good) == (outcome, after, 10.0, True)
    assert sentence([result]) == ("1 of 1 faults were detected." if outcome == "detected" else "")
    (gone,) = judge_faults(bag([(14.0, "gone")], said, **before), [fault(expect=EXPECT)])
    assert (gone.begin_s, gone.end_s) == (10.0, 14.0)
    (of_another_branch,) = judge_faults(bag([], said, **before), [])
    assert (of_another_branch.fault, of_another_branch.begin_s) == ("dead", 10.0)


@pytest.mark.parametrize("text", ["no json", "[1]", '{"dead": 3}', '{"dead": [{}, 1]}', "[" * 10_000])
def test_what_a_bag_says_of_earlier_faults_is_not_believed_unread(text: str) -> None:
    assert faults_before({"faults_before": text}) == {}


def test_a_fault_cannot_show_on_a_topic_that_is_not_there(tmp_path: Path) -> None:
    for topic, hint in (("/drive/statu", "did you mean /drive/status"), ("/odom", "is no status of this run")):
        words = f"{{topic: {topic}, field: a, says: b, within: 1}}"
        told = f"faults=[{{kind: motor_dead, joint: wheel_front_left_joint, at: 1, expect: {words}}}]"
        with pytest.raises(ConfigError, match=hint):
            prepare_scenario("flat_drive", [told])
