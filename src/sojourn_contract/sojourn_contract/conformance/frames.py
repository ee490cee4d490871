"""Frames: header.frame_id and child_frame_id as the table declares them."""

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.topic_types import Topic


class FrameRule:
    """Frames of one topic."""

    name = "frame"

    def __init__(self, row: Topic) -> None:
        self._frames = row.frames
        self._child = row.child_frame
        self._allowed = " or ".join(repr(frame) for frame in row.frames)

    def judge(self, seen: Observation) -> list[Finding]:
        """Frames that are not known."""
        found = []
        if self._frames and seen.message.header.frame_id not in self._frames:
            found.append(Finding("header.frame_id", repr(seen.message.header.frame_id), self._allowed))
        if self._child and seen.message.child_frame_id != self._child:
            found.append(Finding("child_frame_id", repr(seen.message.child_frame_id), repr(self._child)))
        return found
