"""Reads of a bag what its summary needs: of the truth some numbers, of most topics how many messages there are."""

from functools import partial
from pathlib import Path

from sojourn_bags.condensed import EVERY_JOINT, Excerpt
from sojourn_bags.description import Run
from sojourn_bags.detection import FAULT_TEXTS
from sojourn_bags.goals import STATUS_OF, STATUS_TEXTS, VELOCITIES
from sojourn_bags.machine import POSE, joints_to
from sojourn_bags.onset import HEARTBEATS
from sojourn_bags.power_modes import STATUS as POWER_STATUS
from sojourn_bags.reading import Bag, read_bag, read_beginning
from sojourn_bags.summary import is_of_store
from sojourn_contract.goal_topics import FAULTS_TOPIC as FAULTS

PLANS = 60
"""Of a record that begins within a drive, those among which is the first with a place."""


def read_for_summary(path: Path | str) -> Bag:
    """A bag that can be summarised and has little else, so that it fits into memory after days.

    Raises:
        UnreadableBagError: as of `read_bag`. UnknownTopicInBagError: a topic is of another type than in our runs.
        IncompleteConfigError: the description of the run does not stand before its messages, or is of another version.
    """
    run = Run.of_bag(read_beginning(Path(path)))
    return read_bag(path, partial(_kept, _texts(run), _truth(run)))


def _kept(texts: dict[str, tuple[str, ...]], truth: dict[str, Excerpt], topic: str) -> Excerpt | None:
    if topic in STATUS_OF:
        return None
    if topic in texts:
        return Excerpt(texts=texts[topic], is_stamped=True)
    if is_of_store(topic):
        return Excerpt(("voltage", "current", "percentage"), is_stamped=True)
    return truth.get(topic, Excerpt())


def _texts(run: Run) -> dict[str, tuple[str, ...]]:
    """What is read of statuses, by topic: also that by which the faults of a scenario show."""
    found = {
        **dict.fromkeys(STATUS_OF.values(), STATUS_TEXTS),
        POWER_STATUS: ("mode",),
        FAULTS: ("name", "state", "kind"),
        HEARTBEATS: FAULT_TEXTS,
    }
    for fault in run.scenario.faults:
        if fault.expect is not None:
            known = found.get(fault.expect.topic, ())
            found[fault.expect.topic] = tuple(dict.fromkeys((*known, fault.expect.field)))
    return found


def _truth(run: Run) -> dict[str, Excerpt]:
    to_tip = () if run.arm is None else joints_to(run.urdf, run.arm["tip_link"])
    joints = EVERY_JOINT if run.machine.floats else to_tip  # where it floats, all of them move its centre of mass
    stamps = ("header.stamp.sec", "header.stamp.nanosec")
    return {
        "/clock": Excerpt(is_stamped=True),
        "/truth/odom": Excerpt(POSE, is_stamped=True),
        "/truth/joint_states": Excerpt(joints=joints, is_stamped=True),
        "/truth/contacts": Excerpt(points={"sinkage": len(run.machine.stands_on)}),
        "/plan": Excerpt(first=PLANS),
        **dict.fromkeys(VELOCITIES, Excerpt(stamps, is_dated=True)),
    }
