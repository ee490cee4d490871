"""Bounce, pitch and roll of a rigid body on elastic axles, and the filter that the wheelbase makes of the ground.

Heave z (up) and pitch q (nose down positive) at the centre of mass, axle at x_i with rate k_i and damping c_i of both
wheels:

    M = diag(m, J_y),  K = sum k_i [[1, -x_i], [-x_i, x_i^2]],  C alike
    ground h(s) under axle i:  h exp(j w (x_i/V))  of the ground under the centre of mass: front axles meet it earlier
    two equal axles at +-l/2: heave is excited by cos(pi f l/V), pitch by sin(pi f l/V):
        no bounce at f = (n + 1/2) V/l, no pitch at f = n V/l
    roll p about the roll axis: (J_x + m h_s^2) p'' + c_r p' + (k_r - m g h_s) p = m h_s a_y,  k_r = sum k_i t_i^2/4
(Genta and Morello 2009, vol. 2, sec. 26.5 and 26.6; Gillespie 1992, ch. 5.)
Assumptions: small motion, both sides alike, no unsprung masses here (see `quarter_car`), the wheels keep contact.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg import eig

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


class ElasticAxle(NamedTuple):
    """Place forward of the centre of mass [m]; rate [N/m] and damping [N s/m] of both wheels together; track [m]."""

    x: float
    rate: float
    damping: float
    track: float = 1.0


class BodyMode(NamedTuple):
    """Natural frequency [Hz], damping ratio [-], centre of the motion forward of the centre of mass [m].

    The centre of a bounce mode lies outside of the axles, that of a pitch mode between them.
    """

    frequency: float
    damping: float
    centre: float


class RollMotion(NamedTuple):
    """Roll: natural frequency [Hz], damping ratio [-], angle for one unit of lateral acceleration [rad s^2/m], rates of
    the axles over the whole [-]."""

    frequency: float
    damping: float
    flexibility: float
    shares: tuple[float, ...]


def matrices(
    mass: float, pitch_inertia: float, axles: Sequence[ElasticAxle]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mass, damping and stiffness matrices of (heave, pitch), each (2, 2)."""
    for name, value in (("mass", mass), ("pitch_inertia", pitch_inertia)):
        if not (math.isfinite(value) and value > 0.0):
            raise InvalidValueError(name, value, "a finite number more than 0")
    if len(axles) < 2 or any(axle.rate <= 0.0 for axle in axles):
        raise InvalidValueError("axles", axles, "two or more, with rates of more than 0")
    stiffness, damping = np.zeros((2, 2)), np.zeros((2, 2))
    for axle in axles:
        shape = np.array([[1.0, -axle.x], [-axle.x, axle.x**2]])
        stiffness += axle.rate * shape
        damping += axle.damping * shape
    return np.diag([mass, pitch_inertia]), damping, stiffness


def heave_and_pitch_modes(mass: float, pitch_inertia: float, axles: Sequence[ElasticAxle]) -> tuple[BodyMode, ...]:
    """The modes by rising frequency: two, fewer where one is overdamped."""
    m, c, k = matrices(mass, pitch_inertia, axles)
    a = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(m, k), -np.linalg.solve(m, c)]])
    values, vectors = eig(a)
    found = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value.imag > 1e-9:
            heave, pitch = vector[0], vector[1]
            centre = float((heave / pitch).real) if abs(pitch) > 1e-12 * abs(heave) else math.inf
            found.append(BodyMode(abs(value) / (2.0 * math.pi), float(-value.real / abs(value)), centre))
    return tuple(sorted(found))


def response_to_ground(
    mass: float, pitch_inertia: float, axles: Sequence[ElasticAxle], speed: float, frequencies: FloatArray
) -> FloatArray:
    """Complex heave [-] and pitch [rad/m] over the height of the ground under the centre of mass, shape (n, 2)."""
    if not speed > 0.0:
        raise InvalidValueError("speed", speed, "more than 0 m/s")
    m, c, k = matrices(mass, pitch_inertia, axles)
    rows = []
    for frequency in np.asarray(frequencies, dtype=np.float64):
        s = 2j * math.pi * frequency
        force = np.zeros(2, dtype=np.complex128)
        for axle in axles:
            ground = np.exp(s * axle.x / speed) * (axle.rate + s * axle.damping)
            force += ground * np.array([1.0, -axle.x])
        rows.append(np.linalg.solve(s * s * m + s * c + k, force))
    return np.array(rows)


def first_nulls(wheelbase: float, speed: float) -> tuple[float, float]:
    """Lowest frequencies above 0 [Hz] without bounce and without pitch, for two equal axles."""
    if not (wheelbase > 0.0 and speed > 0.0):
        raise InvalidValueError("wheelbase, speed", (wheelbase, speed), "more than 0")
    return 0.5 * speed / wheelbase, speed / wheelbase


def roll_motion(
    mass: float, roll_inertia: float, sprung_height: float, gravity: float, axles: Sequence[ElasticAxle]
) -> RollMotion:
    """Roll about an axis `sprung_height` [m] below the centre of mass; `roll_inertia` at the centre of mass [kg m^2].

    Raises:
        InvalidValueError: springs that do not hold the body upright.
    """
    # both wheels together have `rate`: each side has half of it at half the track
    rates = [0.25 * axle.rate * axle.track**2 for axle in axles]
    damping = sum(0.25 * axle.damping * axle.track**2 for axle in axles)
    stiffness = sum(rates) - mass * gravity * sprung_height
    if stiffness <= 0.0:
        raise InvalidValueError("axles", axles, "roll stiffness that holds the body upright")
    inertia = roll_inertia + mass * sprung_height**2
    natural = math.sqrt(stiffness / inertia)
    return RollMotion(
        natural / (2.0 * math.pi),
        damping / (2.0 * natural * inertia),
        mass * sprung_height / stiffness,
        tuple(rate / sum(rates) for rate in rates),
    )
