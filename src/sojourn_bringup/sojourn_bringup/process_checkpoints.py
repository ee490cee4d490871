"""Checkpoints of nodes that are processes: what they hand over becomes the same file as that of a run in one process,
and where a run goes on each gets back what it had handed over.
"""

import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from sojourn_bringup.checkpoints import CheckpointKeeper, keeper_of
from sojourn_bringup.health import Health
from sojourn_bringup.monitor import Monitor
from sojourn_bringup.plan import RunPlan
from sojourn_bringup.resumption import beginning, handed_back
from sojourn_config.scenario import load_scenario
from sojourn_contract.checkpoint_topic import FILED, RESUMED, STATE, StateParts, as_bytes, as_text, state_messages
from sojourn_contract.codecs import encode
from sojourn_contract.errors import ContractError
from sojourn_contract.handing_over import quality
from sojourn_contract.heartbeat import Heartbeat, read_heartbeats
from sojourn_contract.role_state import ForeignState, Heard, RoleAtCheckpoint, RoleState
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import seconds
from sojourn_contract.state_tree import CheckpointError, packed, unpacked
from sojourn_contract.topic_types import ROLES
from sojourn_contract.values import DiagnosticArray, Header
from sojourn_plant.checkpoints import ANSWERED, SILENT
from sojourn_stack.stack import PLANT, StackState

Handed = dict[str, tuple[Heartbeat, str]]
"""What roles have handed over of one period: the last part of a state, and its whole text."""
AGAIN_S = 5.0
"""Wall time after which a state is handed back once more to a node that has not taken it."""
MOST_WAITING = 64
"""Periods of which states may be here that are not in a file yet: older ones are lost."""


class ProcessCheckpoints:
    """Of one run.

    Args:
        plan: the run. nodes: health by role. say: takes what a person should know.

    Attributes:
        failure: why no more can be kept, in words; "" where they can.
    """

    def __init__(self, plan: RunPlan, nodes: Mapping[str, Health], say: Callable[[str], None]) -> None:
        self._plan, self._nodes, self._say = plan, nodes, say
        self._loaded = plan.loaded or load_scenario(plan.scenario, plan.overrides)
        self._table = table_of(self._loaded)
        self._keeper = keeper_of(plan, self._loaded)
        self._parts = StateParts()
        self._handed: dict[int, Handed] = {}
        """By stamp [ns]. Of several where the plant waits no longer for who is late with a file."""
        self._done = -1 if plan.begin is None else plan.begin.now
        """Stamp up to which nothing more is kept [ns]."""
        self._given: dict[str, float] = {}
        """Wall time at which a state was handed back [s]."""
        self._silent: frozenset[str] = frozenset()
        self._sender: Any = None
        self._filed: Any = None
        self.failure = ""

    def join(self, monitor: Monitor) -> None:
        """Listen and speak where the run is; what its recorder begins with is in a file then. Raises OSError."""
        if self._keeper is not None:
            self._filed = monitor.sender(FILED, quality(FILED))
            monitor.listen(STATE, self._hear, quality(STATE))
        if self._plan.begin is not None:
            self._plan.beginning_file.write_bytes(packed(beginning(self._plan.begin, self._loaded), "beginning"))
            self._sender = monitor.sender(STATE, quality(STATE))

    def look(self) -> None:
        """Hand back what is wanted; what is handed over is written as it comes."""
        if self._sender is not None:
            self._hand_back()

    def _keep(self, keeper: CheckpointKeeper, stamp: int) -> None:
        """Into a file, if all of them are there."""
        if not _is_whole(self._handed[stamp]):
            return
        self._lose([earlier for earlier in self._handed if earlier < stamp])
        self._write(keeper, self._handed.pop(stamp))
        self._done = stamp
        self._filed.publish(encode(FILED, Header(stamp)))

    def _write(self, keeper: CheckpointKeeper, handed: Handed) -> None:
        beat, _ = handed[PLANT]
        silent = frozenset(beat.values.get(SILENT, "").split())
        if silent:
            self._tell(silent)
            return
        try:
            keeper.keep(self._state(handed))
        except (ContractError, OSError) as error:
            self.failure = f"no checkpoint can be kept: {error}"

    def _lose(self, stamps: Iterable[int]) -> None:
        """Those of which a part has not come: each role says its own in turn, and has said a later one."""
        for stamp in sorted(stamps):
            del self._handed[stamp]
            self._say(f"the checkpoint of {seconds(stamp):.2f} s is lost: not all of it has come on {STATE.name}")

    def _tell(self, silent: frozenset[str]) -> None:
        if silent != self._silent:
            self._silent = silent
            one = len(silent) == 1
            what = f"{', '.join(sorted(silent))} {'has' if one else 'have'} not handed over {'its' if one else 'their'}"
            self._say(f"this run is not resumable, no checkpoint of it is kept: {what} state on {STATE.name}")

    def _hear(self, message: DiagnosticArray) -> None:
        for beat in read_heartbeats(message):
            if beat.role not in self._plan.participants or beat.stamp <= self._done:
                continue  # what has been handed back is among it
            text = self._parts.take(beat)
            if text is not None:
                self._handed.setdefault(beat.stamp, {})[beat.role] = (beat, text)
                self._lose(sorted(self._handed)[:-MOST_WAITING])
                if self._keeper is not None and not self.failure:
                    self._keep(self._keeper, beat.stamp)

    def _state(self, everything: Handed) -> StackState:
        """Of the run, from what all have handed over of a period. Raises CheckpointError, RefusedMessageError."""
        roles: dict[str, RoleState] = {}
        messages: dict[str, dict[int, Heard]] = {}
        ahead: list[Any] = []
        own: RoleAtCheckpoint | None = None
        for role in ROLES:
            if role not in everything:
                continue
            beat, text = everything[role]
            if role in self._plan.replacements:
                roles[role] = RoleState(ForeignState(text), published=beat.published, now=beat.stamp)
                continue
            handed = unpacked(as_bytes(text), role)
            if not isinstance(handed, RoleAtCheckpoint):
                raise CheckpointError(role, f"a {type(handed).__name__}: allowed is the state of a role")
            roles[role] = handed.role
            for name, kept in handed.messages.items():
                messages[name] = dict(sorted({**messages.get(name, {}), **kept}.items()))
            ahead += handed.ahead
            own = handed if role == PLANT else own
        if own is None:
            raise CheckpointError(PLANT, "its state has not come")
        return StackState(own.period, roles, messages, ahead=tuple(ahead), leaps=own.leaps)

    def _hand_back(self) -> None:
        """To each that is there and has not said that it goes on."""
        begin, now = self._plan.begin, time.monotonic()
        if begin is None:
            return
        waiting = [role for role in begin.roles if not self._goes_on(self._nodes[role], begin.now)]
        if not waiting:
            self._sender = None
        for role in waiting:
            if self._nodes[role].heard_at and now - self._given.get(role, -AGAIN_S) >= AGAIN_S:
                self._given[role] = now
                one = begin.roles[role]
                is_foreign = isinstance(one.app, ForeignState)
                text = one.app.text if is_foreign else as_text(packed(handed_back(role, begin, self._table), role))
                for message in state_messages(role, begin.now, one.counters, text):
                    self._sender.publish(encode(STATE, message))

    def _goes_on(self, node: Health, stamp: int) -> bool:
        return node.values.get(RESUMED) == str(stamp) or node.stamp > 0


def _is_whole(handed: Handed) -> bool:
    """Whether the plant is among them, and all who it says have answered."""
    if PLANT not in handed or ANSWERED not in handed[PLANT][0].values:
        return False
    return all(role in handed for role in handed[PLANT][0].values[ANSWERED].split())
