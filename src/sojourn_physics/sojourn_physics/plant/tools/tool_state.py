"""What changes of a tool, and what it sees of its surroundings in a period."""

from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import MemoryBoard


class Soil(NamedTuple):
    """Loose soil."""

    volume: float = 0.0
    """[m3]"""
    mass: float = 0.0
    """[kg]"""

    def part(self, volume: float) -> "Soil":
        """So much of it by volume [m3]."""
        return Soil(volume, self.mass * volume / self.volume) if self.volume > 0.0 else Soil()

    def plus(self, other: "Soil") -> "Soil":
        """Both together."""
        return Soil(self.volume + other.volume, self.mass + other.mass)

    def less(self, other: "Soil") -> "Soil":
        """What is left without a part of it."""
        return Soil(self.volume - other.volume, self.mass - other.mass)


@dataclass(frozen=True, slots=True)
class ScoopState:
    """Where the soil is that a scoop has cut."""

    carried: Soil = field(default_factory=Soil)
    pushed: Soil = field(default_factory=Soil)
    """Ahead of it, on the ground."""
    front: tuple[float, float, float] | None = None
    """Edge of the present cut in map [m], behind which soil is taken away; None where it cuts nothing."""
    ahead: tuple[float, float] = (0.0, 0.0)
    """Where pushed soil would be left, in map [m]."""
    taken: float = 0.0
    """Soil that it has taken from the ground since the start, less what it has put back [m3]."""
    has_worked: bool = False

    def report(self) -> dict[str, float]:
        """See `ToolState`."""
        return {
            "tool carried_kg": self.carried.mass,
            "tool carried_m3": self.carried.volume,
            "tool pushed_m3": self.pushed.volume,
            "tool taken_m3": self.taken,
        }


class Hole(NamedTuple):
    """A hole in the ground."""

    x: float
    """Of its mouth in map [m]."""
    y: float
    depth: float
    """Below the ground there [m]."""


@dataclass(frozen=True, slots=True)
class DrillState:
    """What a drill has done."""

    temperature: float
    """Of its bit [K]."""
    holes: tuple[Hole, ...] = ()
    thrust: float = 0.0
    """[N]"""
    torque: float = 0.0
    """At the bit [N m]."""
    stalled: bool = False
    cuttings: float = 0.0
    """Volume drilled out since the start [m3]."""
    has_worked: bool = False

    def report(self) -> dict[str, float]:
        """See `ToolState`."""
        return {
            "tool thrust_n": self.thrust,
            "tool torque_nm": self.torque,
            "tool temperature_k": self.temperature,
            "tool hole_m": max((hole.depth for hole in self.holes), default=0.0),
            "tool cuttings_m3": self.cuttings,
            "tool stalled": float(self.stalled),
        }


@dataclass(frozen=True, slots=True)
class GripperState:
    """What a gripper holds, and where the objects are."""

    places: tuple[tuple[float, float, float], ...]
    """Of each object's centre in map [m]; of one that is held where it was taken from."""
    held: int | None = None
    """Number of the object between the fingers."""
    grasp: float = 0.0
    """Force of a finger on it [N]."""
    needed: float = 0.0
    """Force that its weight and acceleration ask for now [N]."""
    taken_at: float = 0.0
    """Height of the tip when it took what it holds [m]."""
    slips: int = 0
    """How often an object has slipped out since the start."""
    before: tuple[tuple[float, float, float], ...] = ()
    """Tip at the ends of the last two periods in map [m], while it holds something."""
    has_worked: bool = False

    def report(self) -> dict[str, float]:
        """See `ToolState`."""
        values = {
            "tool held": 0.0 if self.held is None else 1.0 + self.held,
            "tool grasp_n": self.grasp,
            "tool needed_n": self.needed,
            "tool slips": float(self.slips),
        }
        for number, place in enumerate(self.places):
            values |= {f"object {number} {axis}": value for axis, value in zip("xyz", place, strict=True)}
        return values


OwnState: TypeAlias = ScoopState | DrillState | GripperState


@dataclass(frozen=True, slots=True)
class ToolState:
    """A tool: its actuator, what it does to the arm and to the contact of its end, and what is its own."""

    own: OwnState
    position: float = 0.0
    """Of the actuator [rad or m]."""
    rate: float = 0.0
    effort: float = 0.0
    """[N m or N]"""
    payload: float = 0.0
    """Mass that hangs on it [kg]."""
    hole: float = 0.0
    """Depth of the ground that it has taken from under its end [m]."""
    pile: float = 0.0
    """Weight of the soil that it pushes ahead [N]."""
    moment: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """That it makes on the arm, in map [N m]."""

    @property
    def has_worked(self) -> bool:
        """Whether there is anything to tell of it."""
        return self.own.has_worked

    def report(self) -> dict[str, float]:
        """What people may want to know of it, by name with its unit."""
        return self.own.report()


@dataclass(frozen=True, slots=True)
class ToolEnergy:
    """What a period has taken [J]; the sums are those of `EnergyAccount`."""

    electrical: float = 0.0
    winding_heat: float = 0.0
    friction_heat: float = 0.0
    soil_work: float = 0.0


@dataclass(frozen=True, slots=True)
class ToolSurroundings:
    """What a tool finds at the end of a period."""

    board: MemoryBoard
    terrain: HeightField
    grid: FloatArray
    soils: FloatArray
    """Kernel rows."""
    gravity: float
    """Its strength [m/s^2]."""
    falling: FloatArray
    """Acceleration of what is let go, in map (3,) [m/s^2]."""
    dt: float
    """Of the period [s]."""
    reference: FloatArray
    """Of the actuator: position, rate, effort (3,)."""
    supply: float
    """Part of its power that it can have, 0 to 1."""
    report: FloatArray
    """Of its end's contact, row of `ReportColumn`."""
    drag: FloatArray
    """Way on which its end is dragged, D of `pad_on_soil`, (2,)."""
    axis: FloatArray
    """Out of the tool, in map (3,)."""
    across: FloatArray
    """Along which a gripper's fingers close, in map (3,)."""
    voltage: float
    """Of the bus [V]."""
