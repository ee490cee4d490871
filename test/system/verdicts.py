"""What of a verdict on a run in real time the host answers for, and what the nodes do."""

from typing import Any

OF_TIME = {"rate", "answer", "heartbeat", "counter", "rate of change"}
"""Rules about when something came: a busy host gives a node no core when it would speak."""


def faults_of_nodes(verdict: dict[str, Any]) -> list[dict[str, Any]]:
    """Groups of a verdict (`Report.as_data`) that no host can be the reason of."""
    groups = [group for group in verdict["groups"] if group["rule"] not in OF_TIME]
    return [group for group in groups if group["rule"] != "stamp" or group["first"][0]["field"] != "age"]
