"""Types and quality of service of endpoints: does a publisher or a subscription meet the others of the contract?

A subscription gets messages only from publishers that offer what it asks for (DDS 1.4, sec. 2.2.3, requested
against offered). The other side is the profile that the table gives.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topic_types import Reliability, Topic

RELIABLE, BEST_EFFORT = "reliable", "best_effort"
VOLATILE = "volatile"
AUTOMATIC = "automatic"
ENDLESS_S = 1e9
"""Durations from here on are without end [s]."""


@dataclass(frozen=True)
class Endpoint:
    """A publisher or a subscription.

    Args:
        type: "package/Name". reliability, durability, liveliness: words as rosbag2 writes them, "" for unknown.
        deadline_s: longest time between two messages [s].
        publishes: False for a subscription.
    """

    type: str
    reliability: str = RELIABLE
    durability: str = VOLATILE
    liveliness: str = AUTOMATIC
    deadline_s: float = float("inf")
    publishes: bool = True

    @classmethod
    def of_graph(cls, info: Any, publishes: bool) -> "Endpoint":
        """An endpoint as rclpy's graph tells of it (rclpy.topic_endpoint_info.TopicEndpointInfo)."""
        profile = info.qos_profile
        deadline_s = profile.deadline.nanoseconds / NANOSECONDS
        return cls(
            type=info.topic_type.replace("/msg/", "/"),
            reliability=profile.reliability.name.lower(),
            durability=profile.durability.name.lower(),
            liveliness=profile.liveliness.name.lower(),
            deadline_s=deadline_s if deadline_s > 0.0 else float("inf"),
            publishes=publishes,
        )


def endpoint_findings(row: Topic, endpoint: Endpoint, lockstep: bool) -> Iterator[Finding]:
    """Why an endpoint does not meet those that the contract has on the other side."""
    if endpoint.type != row.type:
        yield Finding("type", endpoint.type, row.type)
    loose = row.reliability is Reliability.BEST_EFFORT or (row.name == "/clock" and not lockstep)
    who = "a publisher" if endpoint.publishes else "a subscription"
    if endpoint.publishes:
        if endpoint.reliability == BEST_EFFORT and not loose:
            yield Finding("qos.reliability", f"{who} that is {BEST_EFFORT}", RELIABLE)
        return
    if endpoint.reliability == RELIABLE and loose:
        yield Finding("qos.reliability", f"{who} that asks for {RELIABLE}", BEST_EFFORT)
    if endpoint.durability not in ("", VOLATILE, "system_default", "unknown"):
        yield Finding("qos.durability", f"{who} that asks for {endpoint.durability}", VOLATILE)
    if endpoint.deadline_s < ENDLESS_S and endpoint.deadline_s > 0.0:
        yield Finding("qos.deadline", f"{who} that asks for {endpoint.deadline_s:g} s", "none")
    if endpoint.liveliness not in ("", AUTOMATIC, "system_default", "unknown"):
        yield Finding("qos.liveliness", f"{who} that asks for {endpoint.liveliness}", AUTOMATIC)
