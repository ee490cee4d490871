"""Wheels in the ruts of those before them: resistance, slip and sinkage of each pass.

The first wheel presses virgin soil down to z_1 and leaves a rut of depth z_r (`soil.repeated_loading`). The next one
starts from its bottom, meets soil that springs back as far as it has been pressed before and is virgin below, and
sinks to z_2 = z_r + h_2 of the old surface, so that

    greatest sinkage after pass i    z_i = max(z_(i-1), z_r(z_(i-1)) + h_i)

All wheels turn alike and so have one slip. Each pass costs less than the one before, until a load that has been there
finds elastic soil alone: the pull at a slip is greater by the compaction that is spared. Wheels with a track of their
own stay on virgin soil.
(Holm 1969, J. Terramechanics 6(1):45, for the effect; Wong 2008, sec. 2.4.3, for the soil.) Assumptions: straight
driving, tracks that fall together or not at all, nothing flows back into the rut. Range: that of the wheel's law.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sojourn_analysis.vehicle.law_wheel import LawWheel
from sojourn_analysis.vehicle.wheel_traction import WheelForces
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class FollowingWheel:
    """A wheel behind others, as `WheelTraction`.

    Args:
        wheel: on virgin soil. before: wheels that have rolled there, first to last; loads: what they carry [N].
    """

    wheel: LawWheel
    before: tuple[LawWheel, ...]
    loads: tuple[float, ...]

    @property
    def radius(self) -> float:
        """Of the rim [m]."""
        return self.wheel.radius

    def forces(self, load: float, slip: float, speed: float = 0.0) -> WheelForces:
        """As `WheelTraction.forces`; the sinkage is below the bottom of the rut."""
        greatest = 0.0
        for wheel, carried in zip(self.before, self.loads, strict=True):
            greatest = sinkage_after(replace(wheel, greatest=greatest), carried, slip, speed)
        return replace(self.wheel, greatest=greatest).forces(load, slip, speed)


def sinkage_after(wheel: LawWheel, load: float, slip: float, speed: float = 0.0) -> float:
    """Greatest sinkage that the soil has seen after this wheel has passed [m]."""
    return max(wheel.greatest, wheel.rut + wheel.forces(load, slip, speed).sinkage)


def following_wheels(
    wheels: Sequence[LawWheel], loads: FloatArray, tracks: FloatArray
) -> list[LawWheel | FollowingWheel]:
    """The wheels of one side, front to rear, each in the ruts of those whose track it shares.

    Args:
        loads: on each [N], (axles,). tracks: of the axles [m], (axles,).
    """
    found: list[LawWheel | FollowingWheel] = []
    for number, wheel in enumerate(wheels):
        # half of its width on the rut of another: it rolls in it
        before = [k for k in range(number) if abs(tracks[k] - tracks[number]) < wheel.wheel.width]
        if not before:
            found.append(wheel)
            continue
        found.append(FollowingWheel(wheel, tuple(wheels[k] for k in before), tuple(float(loads[k]) for k in before)))
    return found


def passes(wheel: LawWheel, load: float, slip: float, count: int) -> tuple[list[WheelForces], FloatArray]:
    """Forces of wheels that follow one another with one load and slip, and the ruts that they find, (count,) [m]."""
    forces, ruts = [], np.zeros(count)
    for number in range(count):
        forces.append(wheel.forces(load, slip))
        ruts[number] = wheel.rut
        wheel = replace(wheel, greatest=sinkage_after(wheel, load, slip))
    return forces, ruts
