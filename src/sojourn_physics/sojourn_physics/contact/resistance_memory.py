"""A resistance that opposes motion and is continuous through rest: Dahl's friction.

    R = R_0 H,   dH/dt = (v - |v| H)/L

H in -1..1 remembers the sense of motion over the length L (Dahl 1968, Aerospace Corp. TOR-0158; with a linear
law). In steady motion H is the sign of v, at rest it stays. What a reversal gives back is less than R_0 L.
"""

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import StateColumn


@kernel
def advance_headway(speed: float, length: float, dt: float, state: FloatArray) -> float:
    """Advance H over dt [s] of a speed [m/s] with a length [m] more than 0, implicitly; returns it."""
    moved = dt * speed / length
    headway = min(max((state[StateColumn.HEADWAY] + moved) / (1.0 + abs(moved)), -1.0), 1.0)
    state[StateColumn.HEADWAY] = headway
    return float(headway)
