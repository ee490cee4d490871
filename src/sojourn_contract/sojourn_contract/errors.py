"""Errors of the contract: each names the topic and the field, what came and what is allowed."""

from collections.abc import Sequence
from typing import ClassVar


class ContractError(Exception):
    """Base of every error raised by sojourn_contract."""


class UnknownRoleError(ContractError):
    """A role that is in no row of the topic table."""

    def __init__(self, role: str, known: tuple[str, ...]) -> None:
        super().__init__(f"role {role!r} is unknown: known roles are {', '.join(known)}")
        self.role = role


class UnknownTopicError(ContractError):
    """A topic that is in no row of the topic table."""

    def __init__(self, topic: str, known: tuple[str, ...]) -> None:
        super().__init__(f"topic {topic!r} is unknown: known topics are {', '.join(known)}")
        self.topic = topic


class RefusedMessageError(ContractError):
    """A message that breaks its row of the table. It is counted and shown in /diagnostics.

    Args:
        topic: where it arrived.
        field: which field is wrong.
        value: what it holds.
        allowed: what is allowed, in words.
    """

    def __init__(self, topic: str, field: str, value: object, allowed: str) -> None:
        super().__init__(f"{topic}.{field} = {value}: allowed is {allowed}")
        self.topic = topic
        self.field = field
        self.value = value
        self.allowed = allowed


class NotCarriedOutError(RefusedMessageError):
    """A message that keeps its row, and of which something is asked that is not done.

    Args:
        topic: where it arrived. asked: the field that asks. reason: why not, in words.
    """

    def __init__(self, topic: str, asked: str, reason: str) -> None:
        super().__init__(topic, asked, "refused", reason)
        self.args = (f"{topic}: {reason}",)


class TopicNameError(ContractError):
    """A name that no topic of a run can have."""

    def __init__(self, name: str, allowed: str) -> None:
        super().__init__(f"topic {name!r}: allowed is {allowed}")


class UnknownFieldNameError(ContractError):
    """A name by which no field of the contract goes. near: names that look like it."""

    def __init__(self, name: str, reason: str, near: Sequence[str]) -> None:
        meant = f"; the nearest: {', '.join(near)}" if near else ""
        super().__init__(f"{name!r}: {reason}{meant}")
        self.near = tuple(near)


class SensorRowError(ContractError):
    """A row of a kind of sensors that no topic of a run can have."""

    def __init__(self, name: str, allowed: str) -> None:
        super().__init__(f"topic {name!r} of a sensor: allowed is {allowed}")


class UnfitRunError(ContractError):
    """Something of a scenario that the topics of its run do not allow. Each of its parts has a subclass.

    Args:
        what: it is, in words. allowed: what is allowed, in words.
    """

    key: ClassVar[str]
    """Of the scenario."""

    def __init__(self, what: str, allowed: str) -> None:
        super().__init__(f"{self.key}: {what}: allowed is {allowed}")
        self.what, self.allowed = what, allowed


class LeapError(UnfitRunError):
    """Something because of which the clock of a run cannot leap."""

    key = "leaps"


class DisturbanceError(UnfitRunError):
    """A fault between the nodes of a run of what it does not have."""

    key = "faults"


class LinkError(ContractError):
    """Something that a link to Earth cannot do in a run.

    Args:
        key: in the table `link` of the scenario. value: what stands there. allowed: what is allowed, in words.
    """

    def __init__(self, key: tuple[str | int, ...], value: object, allowed: str) -> None:
        super().__init__(f"link.{'.'.join(map(str, key))} = {value}: {allowed}")
        self.key, self.value, self.allowed = key, value, allowed


LONGEST_REASON = 120


def unreadable(topic: str, what: str, error: Exception, data: bytes | None = None) -> RefusedMessageError:
    """Refusal of a message of which `what` was to be made, and could not for an error; `data`: its bytes, if known."""
    reason = " ".join(str(error).split())[:LONGEST_REASON] or type(error).__name__
    size = "its content" if data is None else f"{len(data)} bytes"
    return RefusedMessageError(topic, "message", size, f"{what} ({reason})")


class SilentNodeError(ContractError):
    """A node that did not answer within the stated wall time, in lock-step."""

    def __init__(self, role: str, topic: str, stamp_s: float, waited_s: float) -> None:
        super().__init__(
            f"node '{role}' did not answer: {topic} stamped {stamp_s:.2f} s is missing "
            f"after {waited_s:.1f} s of wall time"
        )
        self.role = role
        self.topic = topic


class NotReadyError(ContractError):
    """A participant that is not ready to begin within the stated wall time."""

    def __init__(self, role: str, reason: str, waited_s: float) -> None:
        super().__init__(f"node '{role}' is not ready after {waited_s:.1f} s of wall time: {reason}")
        self.role = role


class DomainInUseError(ContractError):
    """Another plant already publishes the clock on this domain and namespace."""

    def __init__(self, domain: str, topic: str) -> None:
        super().__init__(
            f"domain {domain} is already in use by another plant (somebody else publishes {topic}): "
            "stop it, or choose another domain with --domain or another namespace with --namespace"
        )
