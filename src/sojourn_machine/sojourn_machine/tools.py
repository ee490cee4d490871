"""The tool at the arm's end: what it is, and the one actuator that it has.

A tool ends in a pad of the rover, the arm's tip, whose size it sets. Its actuator is a joint of its own, `TOOL_JOINT`,
in the messages that name joints; it moves no link of the URDF, whose last link has the mass of turret and tool.
"""

import math
from typing import Annotated, Literal, NamedTuple, TypeAlias

from pydantic import Field, TypeAdapter

from sojourn_machine.drives import GearParams, MotorParams
from sojourn_machine.params import Params
from sojourn_machine.supports import PadParams, ScoopParams

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
    load: str = Field(min_length=1, description="load of the bus that feeds it")
    load_distance: float = Field(
        default=0.0, ge=-0.5, le=0.5, description="from the tip to the middle of what it carries, towards the arm [m]"
    )

    def end(self) -> tuple[float, ScoopParams | None]:
        """Radius of its end [m], and what it cuts soil with when it is dragged."""
        raise NotImplementedError

    def fit(self, pad: PadParams) -> PadParams:
        """The pad with this tool on it."""
        radius, cut = self.end()
        return pad.model_copy(update={"radius": radius, "scoop": cut, "is_tool": True})


class LidParams(Params):
    """The lid that shuts a scoop, turned by a small motor."""

    opening: float = Field(gt=0.0, le=math.pi, description="angle of the open lid; 0 is shut [rad]")
    rate: float = Field(gt=0.0, le=10.0, description="at which it turns [rad/s]")
    power: float = Field(ge=0.0, le=100.0, description="from the bus while it turns [W]")


class ScoopToolParams(_ToolParams):
    """A scoop with a lid: open it cuts and fills, shut it keeps what it has."""

    kind: Literal["scoop"]
    radius: float = Field(gt=0.0, le=0.5, description="of its end, as a plate that is pressed [m]")
    cut: ScoopParams = Field(description="its blade")
    capacity: float = Field(gt=0.0, le=1.0, description="volume that it holds; more is pushed ahead of it [m3]")
    lid: LidParams

    def end(self) -> tuple[float, ScoopParams | None]:
        """See `_ToolParams`."""
        return self.radius, self.cut

    @property
    def joint(self) -> ToolJoint:
        """The lid."""
        return ToolJoint("revolute", 0.0, self.lid.opening, self.lid.rate, True)


class DrillBitParams(Params):
    """A drag bit."""

    radius: float = Field(gt=0.0, le=1.0, description="of the hole [m]")
    thrust_ratio: float = Field(default=0.7, gt=0.0, le=5.0, description="ζ, thrust over drag of a sharp cutter [-]")
    flat_friction: float = Field(default=0.6, ge=0.0, le=2.0, description="μ of the wear flats [-]")
    shape: float = Field(default=1.0, ge=0.5, le=2.0, description="number of the bit's shape [-]")
    flat_force: float = Field(default=0.0, ge=0.0, le=1e5, description="thrust that the wear flats carry [N]")


class BitHeatParams(Params):
    """The bit as one lump of heat."""

    capacity: float = Field(gt=0.0, le=1e5, description="[J/K]")
    conductance: float = Field(ge=0.0, le=100.0, description="to the turret [W/K]")
    share: float = Field(ge=0.0, le=1.0, description="of the power at the bit that heats it; the rest heats chips [-]")
    ambient: float = Field(gt=0.0, le=1000.0, description="temperature of the turret [K]")

    def step(self, temperature: float, power: float, dt: float) -> float:
        """Temperature [K] after `dt` [s] with a power at the bit [W]: C dT/dt = s P - G (T - T_a), implicit."""
        rate = dt / self.capacity
        return (temperature + rate * (self.share * power + self.conductance * self.ambient)) / (
            1.0 + rate * self.conductance
        )


class DrillToolParams(_ToolParams):
    """A rotary drill with a drag bit."""

    kind: Literal["drill"]
    bit: DrillBitParams
    motor: MotorParams
    gear: GearParams
    rate: float = Field(gt=0.0, le=500.0, description="of the spindle, unless a task asks for less [rad/s]")
    acceleration: float = Field(gt=0.0, le=1e4, description="at which the amplifier brings it there [rad/s2]")
    heat: BitHeatParams
    max_temperature: float = Field(gt=0.0, le=2000.0, description="of the bit, at which a task stops [K]")

    def end(self) -> tuple[float, ScoopParams | None]:
        """See `_ToolParams`."""
        return self.bit.radius, None

    @property
    def joint(self) -> ToolJoint:
        """The spindle."""
        return ToolJoint("continuous", -math.inf, math.inf, self.rate, False)


class GripperToolParams(_ToolParams):
    """A parallel gripper with two soft fingers, on a screw that holds without power."""

    kind: Literal["gripper"]
    radius: float = Field(gt=0.0, le=0.5, description="of its end, as a plate that is pressed [m]")
    stroke: float = Field(gt=0.0, le=1.0, description="largest opening [m]")
    speed: float = Field(gt=0.0, le=1.0, description="at which the opening changes [m/s]")
    force: float = Field(gt=0.0, le=1e4, description="largest grasp force of a finger [N]")
    stiffness: float = Field(gt=0.0, le=1e8, description="of the fingers: force by which it closes on an object [N/m]")
    finger_length: float = Field(gt=0.0, le=0.5, description="from the tip back, over which it can grasp [m]")
    power: float = Field(ge=0.0, le=1000.0, description="from the bus while the fingers move [W]")

    def end(self) -> tuple[float, ScoopParams | None]:
        """See `_ToolParams`."""
        return self.radius, None

    @property
    def joint(self) -> ToolJoint:
        """The opening between the fingers."""
        return ToolJoint("prismatic", 0.0, self.stroke, self.speed, True)


class ObjectParams(Params):
    """A thing that lies on the ground, small enough to be picked."""

    name: str = Field(min_length=1, description="name of the object")
    x: float = Field(ge=-1e6, le=1e6, description="position in map [m]")
    y: float = Field(ge=-1e6, le=1e6, description="position in map [m]")
    mass: float = Field(gt=0.0, le=1000.0, description="[kg]")
    width: float = Field(gt=0.0, le=1.0, description="between the fingers [m]")
    height: float = Field(gt=0.0, le=1.0, description="over the ground [m]")
    friction: float = Field(gt=0.0, le=5.0, description="against the fingers [-]")


ToolParams: TypeAlias = Annotated[ScoopToolParams | DrillToolParams | GripperToolParams, Field(discriminator="kind")]
"""A tool; the key `kind` says which."""


def read_tool(text: str) -> ToolParams:
    """A tool from JSON. Raises pydantic's ValidationError."""
    tool: ToolParams = TypeAdapter(ToolParams).validate_json(text)
    return tool
