"""The shell round an app: gives it the messages of a period, and sends what it answers. No memory of its own."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from rclpy.context import Context

from sojourn_config.known_machine import KnownMachine
from sojourn_contract.app import App, Period
from sojourn_contract.disturbed_app import disturbed
from sojourn_contract.kept_data import KEEP_EVERY_NS, Kept, KeptData, KeptDataError
from sojourn_contract.node import ContractNode
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_types import Topic


class AppNode(ContractNode):
    """A node that runs the app of its role.

    ROS parameters, besides those of every node: `kept` (file of what its app must not lose, empty for none), `restarts`
    (how often its role has been started again).

    Args:
        context: rclpy context. overrides: parameter values, as the composed start gives them.
        namespace: ROS namespace, None for the one given on the command line.
        every_period: act at every period (the plant).
    """

    app_class: ClassVar[type[App[Any]]]
    """Made of the scenario that the node's parameters name."""

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
        every_period: bool = False,
    ) -> None:
        kind = self.app_class
        super().__init__(
            kind.role,
            context=context,
            overrides=overrides,
            namespace=namespace,
            every_period=every_period,
        )
        self.acts_in_silence = kind.acts_in_silence
        self.app: App[Any] = disturbed(kind(self.scenario), self.table, self.scenario.disturbances)
        self.app.warm_up()
        self.state = self.app.initial_state()
        kept = self.declare_parameter("kept", "").value
        self._kept = KeptData(Path(kept)) if kept else None
        self._kept_at = 0
        self._starts_again = int(self.declare_parameter("restarts", 0).value) > 0

    def read_scenario(self, name: str, overrides: Sequence[str]) -> KnownMachine:
        """What its app goes by."""
        return self.app_class.read(name, overrides)

    def check(self, row: Topic, message: Any) -> None:
        """The contract's checks, then the app's own."""
        super().check(row, message)
        self.app.check(row, message)

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """One step of the app."""
        if self._starts_again:
            self._starts_again = False
            self.state = self.app.started_again(self.state, stamp, self._read_kept())
        period = Period(stamp, inputs, goals, self.counters.last_refusal)
        self.state, answer = self.app.step(self.state, period)
        for topic, refusal in answer.refusals:
            self.refuse(topic, refusal)
        for text in answer.errors:
            self.get_logger().error(f"{text} at {stamp / 1e9:.2f} s")
        self.finished = self.finished or answer.finished
        if answer.landing:
            self.barrier.leap(*(each // CONTROL_PERIOD_NS for each in (stamp, answer.landing)))
        self.publish_all(answer.messages)
        if self._kept is not None and abs(stamp - self._kept_at) >= KEEP_EVERY_NS:
            self._keep(stamp)

    def publish_all(self, messages: Iterable[tuple[str, Any]]) -> None:
        """Publish those of (topic, message) that this run has."""
        for topic, message in messages:
            if self.gives(topic):
                self.publish(topic, message)

    def _read_kept(self) -> Kept | None:
        try:
            return None if self._kept is None else self._kept.read()
        except KeptDataError as error:
            self.get_logger().error(str(error))
            return None

    def _keep(self, stamp: int) -> None:
        """Keep what the app must not lose."""
        assert self._kept is not None
        values = self.app.to_keep(self.state)
        self._kept_at = stamp
        if values is None:
            return
        try:
            self._kept.write(stamp, values)
        except OSError as error:
            self.get_logger().error(f"nothing can be kept: {error}", throttle_duration_sec=10.0)

    def on_new_time(self) -> None:
        """The clock was wrong."""
        self.state = self.app.on_new_time(self.state)

    def heartbeat_values(self) -> dict[str, str]:
        """What the app tells of itself."""
        return self.app.heartbeat_values(self.state, self.now)
