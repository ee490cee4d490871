"""How the base of a machine that floats has moved, from the truth in its bag."""

from dataclasses import dataclass

import numpy as np

from sojourn_bags.machine import FloatArray, TrueMachine, poses_of
from sojourn_bags.reading import Bag

MOMENTA = tuple(f"{kind} {axis}" for kind in ("momentum", "angular momentum") for axis in "xyz")
"""Of all links, in /truth/loads."""


@dataclass(frozen=True, eq=False)
class AfloatMotion:
    """Since the start of the run; arrays (n, ...)."""

    times: FloatArray
    """[s]"""
    base: FloatArray
    """Displacement of base_link in map, (n, 3) [m]."""
    centre: FloatArray
    """Of the common centre of mass, (n, 3) [m]."""
    turn: FloatArray
    """Angle by which the base is turned from its attitude at the start, (n,) [rad]."""

    def figures(self) -> dict[str, float]:
        """The largest of each, for a summary."""
        return {
            "base_moved_m": float(np.linalg.norm(self.base, axis=1).max()),
            "base_turned_deg": float(np.degrees(self.turn.max())),
            "centre_of_mass_moved_m": float(np.linalg.norm(self.centre, axis=1).max()),
        }

    def words(self) -> str:
        """The same for people."""
        found = self.figures()
        moved, turned = 1e3 * found["base_moved_m"], found["base_turned_deg"]
        drift = 1e3 * found["centre_of_mass_moved_m"]
        base = f"Its base moved by {moved:.1f} mm and turned by {turned:.2f} degrees"
        return f"{base}, its centre of mass by {drift:.2f} mm."


def base_motion(bag: Bag, machine: TrueMachine) -> AfloatMotion:
    """Of a bag with the truth."""
    times, poses = bag["/truth/odom"].times, poses_of(bag, "/truth/odom")
    centres = machine.centres_of_mass(times)
    cosine = np.abs(poses[:, 3:] @ poses[0, 3:])
    turn = 2.0 * np.arccos(np.clip(cosine, 0.0, 1.0))
    return AfloatMotion(times, poses[:, :3] - poses[0, :3], centres - centres[0], turn)


def momenta(bag: Bag) -> tuple[FloatArray, FloatArray]:
    """Times (n,) [s] and momentum of all links in map, (n, 6): linear [N s], angular about their centre [N m s]."""
    loads = bag["/truth/loads"]
    rows = [[float(status.get(name, "nan")) for name in MOMENTA] for status in loads.statuses()]
    return loads.times, np.array(rows).reshape(len(rows), len(MOMENTA))
