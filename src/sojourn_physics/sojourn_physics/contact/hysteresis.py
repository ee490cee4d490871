"""The loop that stress and displacement of soil run through when shear turns: Masing's rule about the largest
displacement.

Janosi and Hanamoto's law has the stress of soil that is sheared one way, from rest, as a function of the displacement
u. Sheared to and fro, soil follows steeper branches and loses energy (Masing 1926, Proc. 2nd Int. Congr. Appl. Mech.:
332; Iwan 1966, J. Appl. Mech. 33:893). Here the stress follows an effective displacement e, the sum of sliders that
stick and slip in parallel (Iwan), each with a displacement q_k, a stiffness w_k and a yield radius ρ_k M, where M is
the largest |u| that the soil has seen:

    e = Σ w_k q_k,   dq_k = du,  |q_k| <= ρ_k M     with   Σ w_k ρ_k = 1,   M = max |u|

- Sheared one way each slider stays on its yield radius, q_k = ρ_k u, and e = u: Janosi's law as it is, in steady
  rolling, too, where soil is renewed (u, M and q_k are given up alike, see `shear_memory`).
- Turned back from any point the branch is twice as large as the backbone of the sliders, B(x) = Σ w_k min(x, ρ_k)
  (Masing), inside earlier loops as outside (extended rules: Pyke 1979, J. Geotech. Eng. Div. 105(GT6):715), in any
  direction of the plane.
- Each slider only slips against what it holds: it takes work and never gives any beyond what it has stored.

Masing's rule on Janosi's exponential itself would lose nothing in a small loop: its damping ratio at an amplitude A is
(2/π)[2 (a - f)/(f a) - 1], f = 1 - e^-a, a = A/K, so 0.001 at 0.2 mm and 0.06 at 10 mm for K = 18 mm; soil has 0.2 to
0.25 (Seed & Idriss 1970, EERC 70-10, sand strained by some per cent). Hence B is a power law x^β through the yield
radii ρ_k = ρ 4^(k - 4), and flat beyond the last, ρ: a backbone x^β has the damping ratio (2/π)(1 - β)/(1 + β) at every
amplitude, 0.26 for β = 0.42, and these four sliders 0.20 to 0.28 from loops as large as M down to a sixteenth of it.
What is smaller than ρ M/64 is elastic, with a dozen times the stiffness of the first loading (soil at small strain:
Hardin & Drnevich 1972, J. Soil Mech. Found. Div. 98(SM7):667).

Assumption: damping does not depend on amplitude; soil strained by less than 0.01 % loses less (Seed & Idriss 1970).
"""

import math

import numpy as np

from sojourn_machine.kernels import small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import SLIDERS, StateColumn

EXPONENT = 0.42
"""β of the backbone [-]."""
LARGEST_YIELD = 0.9
"""ρ of the last slider: beyond it a loop as large as M slips with all of them [-]."""
RATIO = 4.0
"""Of the yield radii [-]."""
YIELD: FloatArray = LARGEST_YIELD * RATIO ** np.arange(1.0 - SLIDERS, 1.0)
"""ρ_k, (SLIDERS,) [-]."""


def _stiffness() -> FloatArray:
    """w_k, (SLIDERS,) [-], with which B is a power law at the yield radii and 1 beyond."""
    backbone = (YIELD / LARGEST_YIELD) ** EXPONENT
    slopes = np.diff(backbone, prepend=0.0) / np.diff(YIELD, prepend=0.0)
    return np.asarray(slopes - np.append(slopes[1:], 0.0))


STIFFNESS: FloatArray = _stiffness()
ON_BACKBONE = -1.0
"""In place of M: soil that is being sheared for the first time in every direction, de = du about any e. Curves of small
changes have a tangent only so: about a point where shear turns, first loading and unloading differ (see
`sojourn_analysis.modal.linearise`)."""
ROUNDING = 1e-12
"""By how much a slider may be beyond its yield radius, over that: so that what slips no more is left alone."""

_FIRST = len(StateColumn)


@small_kernel
def effective_shear(
    moved_x: float, moved_y: float, moved_z: float, kept: float, displacement: float, state: FloatArray
) -> tuple[float, float, float]:
    """Advance the sliders of a contact and give e [m], three components in the axes of the displacement.

    Args:
        moved_x, moved_y, moved_z: of the displacement in this step [m]. kept: part of the soil that is not renewed in
            it, 0..1. displacement: |u| after the step [m]. state: row of the contact's state, written.
    """
    on_backbone = state[StateColumn.LARGEST_SHEAR] < 0.0
    largest = (
        state[StateColumn.LARGEST_SHEAR] if on_backbone else max(state[StateColumn.LARGEST_SHEAR] * kept, displacement)
    )
    state[StateColumn.LARGEST_SHEAR] = largest
    e_x = e_y = e_z = 0.0
    for k in range(SLIDERS):
        at = _FIRST + 3 * k
        follows = YIELD[k] if on_backbone else 1.0
        x = (state[at] + follows * moved_x) * kept
        y = (state[at + 1] + follows * moved_y) * kept
        z = (state[at + 2] + follows * moved_z) * kept
        held = x * x + y * y + z * z
        radius = YIELD[k] * largest
        if not on_backbone and held > radius * radius * (1.0 + 2.0 * ROUNDING):
            slip = radius / math.sqrt(held)
            x *= slip
            y *= slip
            z *= slip
        state[at] = x
        state[at + 1] = y
        state[at + 2] = z
        e_x += STIFFNESS[k] * x
        e_y += STIFFNESS[k] * y
        e_z += STIFFNESS[k] * z
    return e_x, e_y, e_z
