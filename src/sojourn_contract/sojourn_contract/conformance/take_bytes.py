"""Hands a serialised message to the judge; one that cannot be read is a finding."""

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.judge import Judge
from sojourn_contract.decoding import decoded, refusing
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import Topic


def take_bytes(judge: Judge, row: Topic, data: bytes) -> None:
    """Judge a message of a row of the table."""
    try:
        message = decoded(row.name, row.type, data)
        with refusing(row.name, f"a {row.type} that can be judged"):
            judge.take(row.name, message)
    except RefusedMessageError as refusal:
        judge.report.add("type", row.name, None, [Finding.of_refusal(refusal)])
