"""Faults of what lies between the nodes of a run: messages on their way to whoever hears them.

They come at a time that is known beforehand, or by the chance of a seed, and may go at one, for in lock-step whoever
waits for a message knows whether there will be one. What the record has is what was said, not what was heard of it.
"""

from collections.abc import Iterable
from typing import ClassVar, Self

from pydantic import Field, model_validator

from sojourn_machine.chance import stream_of
from sojourn_machine.disturbance import FOR_EVER, Disturbance, Effect
from sojourn_machine.fault_choice import LATEST, FaultableMachine, FaultChoice, FaultProblem
from sojourn_machine.timing import CONTROL_PERIOD_NS, period_stamp

TIMING_TOPICS = ("/clock", "/operator/tick", "/faults", "/diagnostics")
"""By which a run goes on: what happens to them is the run's end and no fault of it."""
LONGEST_JUMP = 1e6
"""Of a clock [s]."""
ON_BOARD = ("sensors", "drive", "arm", "power")
"""Roles of the machine's own nodes. They may fall silent in a run that goes on: without its plant or operator there is
none.
"""


class TransportFault(FaultChoice):
    """Base of the kinds."""

    effect: ClassVar[Effect] = "lost"

    @property
    def in_scenario_alone(self) -> bool:
        """See FaultChoice."""
        return True

    @model_validator(mode="after")
    def _is_known_beforehand(self) -> Self:
        if self.when is not None and self.when.between is None:
            raise ValueError("when: allowed is between, for whoever waits for a message knows when it comes")
        return self

    def disturbance(self, seed: int) -> Disturbance | None:
        """See FaultChoice."""
        time = self.time(seed)
        if time is None:
            return None
        begin = period_stamp(time)
        end = FOR_EVER if self.until is None else period_stamp(self.until)
        return self._disturbance(begin, end if self.lasts is None else begin + period_stamp(self.lasts), seed)

    def _disturbance(self, begin: int, end: int, seed: int) -> Disturbance:
        raise NotImplementedError


class LateFault(TransportFault):
    """Mixed into kinds by which messages arrive later, none before an earlier one."""

    effect: ClassVar[Effect] = "late"
    delay: float = Field(gt=0.0, le=LATEST, description="after which a message arrives [s]")

    def disturbance(self, seed: int) -> Disturbance | None:
        """See FaultChoice."""
        found = super().disturbance(seed)
        return None if found is None else found._replace(delay=period_stamp(self.delay))


class MessageFault(TransportFault):
    """Of the messages of one topic."""

    target: ClassVar[str] = "topic"
    topic: str = Field(min_length=1, description="whose messages it meets")
    probability: float = Field(default=1.0, gt=0.0, le=1.0, description="of each message, that it is met [-]")

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice; which topics a run has is known to its table."""
        if self.topic in TIMING_TOPICS:
            yield "topic", self.topic, "holds the run together: allowed is another one than " + ", ".join(TIMING_TOPICS)

    def _disturbance(self, begin: int, end: int, seed: int) -> Disturbance:
        stream = stream_of(seed, self.called)
        return Disturbance(self.effect, self.topic, "", begin, end, self.probability, stream=stream)


class MessageLost(MessageFault):
    """They do not arrive."""

    kind: str = "message_lost"


class MessageRepeated(MessageFault):
    """They arrive twice: a command is given twice, the second of two equal readings is refused."""

    effect: ClassVar[Effect] = "twice"
    kind: str = "message_repeated"


class MessageCorrupted(MessageFault):
    """A bit of them is another, of a number, a text or bytes. Whoever hears one refuses it if the contract does, and
    else believes it.
    """

    effect: ClassVar[Effect] = "corrupted"
    kind: str = "message_corrupted"


class MessageLate(LateFault, MessageFault):
    """They arrive later."""

    kind: str = "message_late"


class NodeFault(TransportFault):
    """Of the node of a role."""

    target: ClassVar[str] = "node"
    node: str = Field(description="role of the node")

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        if self.node not in ON_BOARD:
            yield "node", self.node, f"cannot have it: allowed is one of {', '.join(ON_BOARD)}"

    def _disturbance(self, begin: int, end: int, seed: int) -> Disturbance:
        return Disturbance(self.effect, "", self.node, begin, end)


class NodeSilent(NodeFault):
    """It is gone, or hangs: nothing of it is heard."""

    kind: str = "node_silent"


class NodeSlow(LateFault, NodeFault):
    """All that it says is late."""

    kind: str = "node_slow"


class NodeTimeJump(NodeFault):
    """Its clock is off, forward or back: so are the stamps of what it says. Whoever hears it refuses what is of a time
    to come or too old, and takes the rest for as old as it says.
    """

    effect: ClassVar[Effect] = "shifted"
    kind: str = "node_time_jump"
    by: float = Field(
        ge=-LONGEST_JUMP, le=LONGEST_JUMP, description="by which its clock is ahead; behind where < 0 [s]"
    )

    @model_validator(mode="after")
    def _jumps(self) -> Self:
        if abs(self.by) * 1e9 < CONTROL_PERIOD_NS:
            raise ValueError(f"by = {self.by:g}: allowed is a control period of 0.02 s or more, forward or back")
        return self

    def disturbance(self, seed: int) -> Disturbance | None:
        """See FaultChoice."""
        found = super().disturbance(seed)
        shift = period_stamp(abs(self.by))
        return None if found is None else found._replace(shift=shift if self.by > 0.0 else -shift)


class NodeKilled(NodeFault):
    """Its process is killed: nothing of it is heard, and what is wanted of it meanwhile is lost. When the fault goes
    another process begins, which knows what the first had kept.
    """

    effect: ClassVar[Effect] = "killed"
    kind: str = "node_killed"


class NodeRestarted(NodeFault):
    """Its process ends and another begins, which knows what the first has kept."""

    effect: ClassVar[Effect] = "restarted"
    heals: ClassVar[bool] = False
    kind: str = "node_restarted"
