"""The tool at the arm's end: what it is, and the one actuator that it has.

A tool ends in a pad of the rover, the arm's tip, whose size it sets. Its actuator is a joint of its own, `TOOL_JOINT`,
in the messages that name joints; it moves no link of the URDF, whose last link has the mass of turret and tool.
"""

import math
from typing import Literal, NamedTuple, TypeAlias

from pydantic import Field, TypeAdapter

from sojourn_mechanics.contact.params import PadParams, ScoopParams
from sojourn_mechanics.params import Params

TOOL_JOINT = "tool_joint"


class ToolJoint(NamedTuple):
    """The actuator as messages see it."""

    kind: Literal["revolute", "continuous", "prismatic"]
    lower: float
    """[rad or m]"""
    upper: float
    velocity: float
    """Its fastest [rad/s or m/s]."""
    held: bool
    """Whether it is commanded by position; if not, by rate."""


class _ToolParams(Params):
    """What every tool has."""

    pad: str = Field(min_length=1, description="pad of the rover that is the tool's end")
    radius: float = Field(gt=0.0, le=0.5, description="of that end [m]")
    load: str = Field(min_length=1, description="load of the bus that feeds it")
    load_distance: float = Field(
        default=0.0, ge=-0.5, le=0.5, description="from the tip to the middle of what it carries, towards the arm [m]"
    )

    def fit(self, pad: PadParams) -> PadParams:
        """The pad with this tool on it."""
        return pad.model_copy(update={"radius": self.radius, "scoop": None, "is_tool": True})


class LidParams(Params):
    """The lid that shuts a scoop, turned by a small motor."""

    opening: float = Field(gt=0.0, le=math.pi, description="angle of the open lid; 0 is shut [rad]")
    rate: float = Field(gt=0.0, le=10.0, description="at which it turns [rad/s]")
    power: float = Field(ge=0.0, le=100.0, description="from the bus while it turns [W]")


class ScoopToolParams(_ToolParams):
    """A scoop with a lid: open it cuts and fills, shut it keeps what it has."""

    kind: Literal["scoop"]
    cut: ScoopParams = Field(description="its blade")
    capacity: float = Field(gt=0.0, le=1.0, description="volume that it holds; more is pushed ahead of it [m3]")
    lid: LidParams

    def fit(self, pad: PadParams) -> PadParams:
        """The pad with this tool on it."""
        return super().fit(pad).model_copy(update={"scoop": self.cut})

    @property
    def joint(self) -> ToolJoint:
        """The lid."""
        return ToolJoint("revolute", 0.0, self.lid.opening, self.lid.rate, True)


ToolParams: TypeAlias = ScoopToolParams
"""A tool; the key `kind` says which."""


def read_tool(text: str) -> ToolParams:
    """A tool from JSON. Raises pydantic's ValidationError."""
    tool: ToolParams = TypeAdapter(ToolParams).validate_json(text)
    return tool
