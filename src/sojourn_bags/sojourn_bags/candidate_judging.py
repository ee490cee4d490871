"""Judges a candidate by the contract while a bag is played to it: no other node takes part.

with run_configuration(bag) as configuration:
    report = judge_candidate(bag, "drive", NodeCandidate(DriveNode), configuration, ReplaySettings(domain=7))
"""

from dataclasses import replace

from sojourn_bags.candidate import Candidate
from sojourn_bags.judging import machine_of
from sojourn_bags.reading import Bag
from sojourn_bags.replay import play
from sojourn_bags.replay_harness import ReplaySettings
from sojourn_bags.replay_script import ReplayPeriod, ReplayScript, script_of
from sojourn_bags.run_configuration import RunConfiguration
from sojourn_contract.conformance.findings import Report
from sojourn_contract.conformance.judge import Judge
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.conformance.take_bytes import take_bytes
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_types import Topic


class CandidateJudge:
    """Listens to a replay and hands everything to the judge, who judges the candidate alone.

    Args:
        script: what is played. machine: the rover.
    """

    def __init__(self, script: ReplayScript, machine: JudgedMachine) -> None:
        self._script = script
        rows = {row.name for row in (*script.inputs, *script.table.outputs_of(script.role))}
        self._judge = Judge(
            replace(machine, table=script.table),
            lockstep=True,
            participants=script.participants,
            roles=(script.role,),
            unseen=[row.name for row in script.table if row.name not in rows],
        )

    def sent(self, step: ReplayPeriod) -> None:
        """The judge knows by the inputs what the candidate was asked, and by /clock what time it is."""
        for name, data in (*step.goals, *step.inputs):
            take_bytes(self._judge, self._script.table.topic(name), data)

    def heard(self, row: Topic, _stamp: int, data: bytes) -> None:
        """Judge a message of the candidate."""
        take_bytes(self._judge, row, data)

    def finish(self) -> Report:
        """The verdict. An answer is asked for in every period that has been played."""
        return self._judge.finish(until=self._script.steps[-1].period * CONTROL_PERIOD_NS)


def judge_candidate(
    bag: Bag,
    role: str,
    candidate: Candidate,
    configuration: RunConfiguration,
    settings: ReplaySettings,
    machine: JudgedMachine | None = None,
) -> Report:
    """Play a bag to a candidate and judge what it says; its answers need not be those of the bag.

    Args:
        role, candidate, configuration, settings: as in `replay`.
        machine: the rover, None for the one that the bag describes.

    Raises:
        ReplayError: the bag cannot be played to this role. UnansweredError: the candidate does not answer, or cannot
            be heard. UnjudgeableBagError: the bag does not describe its rover.
        OtherContractError, IncompleteConfigError: of the bag.
    """
    script = script_of(bag, role)
    judge = CandidateJudge(script, machine or machine_of(bag))
    play(script, candidate, configuration, settings, judge)
    return judge.finish()
