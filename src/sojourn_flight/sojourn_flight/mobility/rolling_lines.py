"""The two lines that each wheel gives in the twist of a body that moves over a plane.

A wheel whose body is turned by q about the pivot P acts at p = P + R(q) c, with c its arm from the pivot. The body
moves with the twist (v_x, v_y, w) of base_link, and the pivot turns at the rate q'. With the heading h = (cos q, sin q)
and n to its left:

    rolling   e . (v + w z x p + q' z x R c) = r W,       e = h + cot(eta) n
    sliding   n . (v + w z x p + q' z x R c) = 0

both linear:  a_x v_x + a_y v_y + a_w w + a_0 = r W or 0, with a_0 what the steering's own rate adds. W is the wheel's
rate, r its radius. An ordinary wheel has cot(eta) = 0. A wheel with rollers at the angle eta to its axle holds the
ground along the rollers' axis only: it has no sliding line (its weight is 0).

Sources: Siegwart, Nourbakhsh, Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed. (2011), section 3.2
(fixed, steered, castor and Swedish wheel); Muir and Neuman, J. Robotic Systems 4 (1987) 281.

Assumptions: plane ground, point contact, vertical pivot. Exact for any speed (pure kinematics).
"""

import math

from sojourn_flight.mobility.wheel_table import WheelTableColumn
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

_PIVOT_X = int(WheelTableColumn.PIVOT_X)
_PIVOT_Y = int(WheelTableColumn.PIVOT_Y)
_ARM_X = int(WheelTableColumn.ARM_X)
_ARM_Y = int(WheelTableColumn.ARM_Y)
_ROLLER = int(WheelTableColumn.ROLLER)


@njit(cache=True)
def rolling_line(row: FloatArray, angle: float, steer_rate: float) -> tuple[float, float, float, float]:
    """a_x, a_y, a_w [m] and a_0 [m/s] of 'it rolls', for a row of the table, the steer angle [rad] and its rate."""
    cosine, sine = math.cos(angle), math.sin(angle)
    e_x, e_y = cosine - row[_ROLLER] * sine, sine + row[_ROLLER] * cosine
    x, y = acts_at(row, cosine, sine)
    return e_x, e_y, x * e_y - y * e_x, steer_rate * (row[_ROLLER] * row[_ARM_X] - row[_ARM_Y])


@njit(cache=True)
def sliding_line(row: FloatArray, angle: float, steer_rate: float) -> tuple[float, float, float, float]:
    """a_x, a_y, a_w [m] and a_0 [m/s] of 'it does not slide sideways'."""
    cosine, sine = math.cos(angle), math.sin(angle)
    x, y = acts_at(row, cosine, sine)
    return -sine, cosine, x * cosine + y * sine, steer_rate * row[_ARM_X]


@njit(cache=True)
def acts_at(row: FloatArray, cosine: float, sine: float) -> tuple[float, float]:
    """Where the wheel acts in base_link [m], its body turned by an angle with this cosine and sine."""
    x = row[_PIVOT_X] + (cosine * row[_ARM_X] - sine * row[_ARM_Y])
    y = row[_PIVOT_Y] + (sine * row[_ARM_X] + cosine * row[_ARM_Y])
    return x, y
