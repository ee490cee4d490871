"""What a linearised plant tells: modes and their names, reduction to mechanical states, answers to ground and steering.

    modes       eigenvalues l of A: natural frequency |l|/2 pi, damping ratio -Re l/|l|. What moves is told by the
                kinetic energy of each coordinate, s_i = Re(w_i* (M w)_i)/(w* M w), w the rates of its eigenvector
    reduced     memory m eliminated. What it forgets slowly, below a limit, as the shear of a contact at rest or at a
                crawl, moves with the coordinates, m = T y with T = A_mw; what it forgets fast stands, m = -A_mm^-1
                (A_my y + A_mw w); integrals of position servos, slower than any motion here, are held. Exact at rest;
                between the limits it is an approximation, which `modes` of the whole A can judge
    responses   H(f) = C (s I - A)^-1 B(s) + D(s), s = 2 pi j f. Driving at V over a profile h(x), wheel i at x_i meets
                h e^(-s (x_first - x_i)/V) and its slope s/V of it (wheelbase filter, both tracks alike or opposite)

(Genta 2009, Vibration Dynamics and Control, ch. 4 and 5; Newland 1989, Mechanical Vibration Analysis, ch. 6.)
Range: that of `linearise`; profiles longer than a wheel's contact.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sojourn_analysis.modal.linearise import LinearPlant
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

ComplexArray: TypeAlias = NDArray[np.complex128]

SLOWEST_HZ = 1e-3
"""Below it a pair of eigenvalues counts as drift."""
NAMED_SHARE = 0.75
"""Of the kinetic energy that the coordinates in a mode's name have together."""
MOST_NAMES = 4
SERVO = "servo "


class Mode(NamedTuple):
    """Natural frequency [Hz], damping ratio [-], eigenvalue [1/s], and shares of the kinetic energy, largest first."""

    frequency: float
    damping: float
    eigenvalue: complex
    shares: Mapping[str, float]

    @property
    def name(self) -> str:
        """The coordinates that have most of the kinetic energy."""
        names: list[str] = []
        total = 0.0
        for name, share in self.shares.items():
            names.append(name)
            total += share
            if total >= NAMED_SHARE or len(names) == MOST_NAMES:
                break
        return ", ".join(names)


def modes(plant: LinearPlant, a: FloatArray | None = None) -> list[Mode]:
    """Modes that swing, slowest first.

    Args:
        a: another A whose first rows are (y, w), as from `reduced`; that of the plant if left out.
    """
    values, vectors = np.linalg.eig(plant.a if a is None else a)
    found = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value.imag > 2.0 * math.pi * SLOWEST_HZ:
            found.append(_mode(plant, complex(value), vector))
    return sorted(found, key=lambda mode: mode.frequency)


def _mode(plant: LinearPlant, value: complex, vector: ComplexArray) -> Mode:
    rates = vector[plant.size : 2 * plant.size]
    energies = np.real(np.conj(rates) * (plant.mass @ rates))
    shares = energies / energies.sum()
    order = np.argsort(-shares)
    return Mode(
        abs(value) / (2.0 * math.pi),
        -value.real / abs(value),
        value,
        {plant.coordinates[index]: float(shares[index]) for index in order},
    )


def reduced(plant: LinearPlant, slow: float = 10.0) -> tuple[FloatArray, FloatArray]:
    """A, (2 n, 2 n), and B, (2 n, p), of the mechanical states (y, w) alone.

    Args:
        slow: memory that decays at less than this rate [1/s] moves with the coordinates.
    """
    size = 2 * plant.size
    a, b = plant.a, plant.b
    decay = -np.diag(a)[size:]
    places_of_servos = np.array([name.startswith(SERVO) for name in plant.memory], dtype=bool)
    # the integral of a rate servo is an angle; that of a position servo answers to angles, and slowly
    answers_to_place = np.abs(a[size:, : plant.size]).max(axis=1) > 1e-6
    held = places_of_servos & answers_to_place
    follows = ~held & (decay < slow)
    fast = ~held & ~follows
    follows_rows, fast_rows = size + np.flatnonzero(follows), size + np.flatnonzero(fast)
    carried = np.zeros((len(follows_rows), size))
    carried[:, : plant.size] = a[follows_rows, plant.size : size]
    mechanical = a[:size, :size] + a[:size, follows_rows] @ carried
    inputs = b[:size].copy()
    if len(fast_rows):
        right = a[fast_rows, :size] + a[np.ix_(fast_rows, follows_rows)] @ carried
        inverse = np.linalg.solve(a[np.ix_(fast_rows, fast_rows)], np.column_stack([right, b[fast_rows]]))
        mechanical = mechanical - a[:size, fast_rows] @ inverse[:, :size]
        inputs -= a[:size, fast_rows] @ inverse[:, size:]
    return mechanical, inputs


def response(
    plant: LinearPlant, output: str, drive: Mapping[str, complex] | str, frequencies: FloatArray
) -> ComplexArray:
    """Acceleration of a coordinate over an input, complex, shape (frequencies,).

    Args:
        output: coordinate. drive: an input, or amplitudes of several. frequencies: more than 0 [Hz].
    """
    amplitudes = {drive: 1.0 + 0.0j} if isinstance(drive, str) else drive
    right = np.zeros(len(plant.inputs), dtype=np.complex128)
    for name, amplitude in amplitudes.items():
        right[_input(plant, name)] = amplitude
    return _solve(plant, output, np.tile(right, (len(frequencies), 1)), frequencies)


def ground_response(plant: LinearPlant, output: str, frequencies: FloatArray, opposite: bool = False) -> ComplexArray:
    """Acceleration of a coordinate [1/s^2 a metre of ground] driving over a profile, complex, shape (frequencies,).

    Args:
        output: coordinate. frequencies: more than 0 [Hz]. opposite: the right track has the other sign.

    Raises:
        InvalidValueError: a plant that does not drive forward.
    """
    if plant.speed <= 0.0:
        raise InvalidValueError("speed", plant.speed, "more than 0 m/s to drive over a profile")
    s = 2j * math.pi * np.asarray(frequencies, dtype=np.float64)
    right = np.zeros((len(s), len(plant.inputs)), dtype=np.complex128)
    names = [name.removeprefix("height ") for name in plant.inputs if name.startswith("height ")]
    first = float(plant.places[:, 0].max())
    for name, place in zip(names, plant.places, strict=True):
        sign = -1.0 if opposite and place[1] < 0.0 else 1.0
        late = sign * np.exp(-s * (first - place[0]) / plant.speed)
        right[:, _input(plant, f"height {name}")] = late
        right[:, _input(plant, f"slope {name}")] = late * s / plant.speed
    return _solve(plant, output, right, frequencies)


def _solve(plant: LinearPlant, output: str, right: ComplexArray, frequencies: FloatArray) -> ComplexArray:
    c, d = plant.acceleration(output)
    unit = np.eye(len(plant.a))
    answers = []
    for frequency, given in zip(np.asarray(frequencies, dtype=np.float64), right, strict=True):
        states = np.linalg.solve(2j * math.pi * frequency * unit - plant.a, plant.b @ given)
        answers.append(c @ states + d @ given)
    return np.array(answers)


def _input(plant: LinearPlant, name: str) -> int:
    if name not in plant.inputs:
        raise InvalidValueError("input", name, "one of " + ", ".join(plant.inputs))
    return plant.inputs.index(name)
