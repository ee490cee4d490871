"""A machine on two tracks: how it stands, and what it gets over by its shape.

    mean pressure under the flat runs   p_m = W/(2 b l)
    widest trench                       the flat run ahead of the centre of mass, or behind it, whichever is less
    highest step                        least of  h_end = L sin α + r cos α   (where the belt's front end is upright)
                                        and       max over θ of  (d - h tan θ) sin θ

with L, α, r the incline and the wheel at the front, d from the rear end of the flat run to the centre of mass along it,
h its height over the run. The second is the balance on the edge: pitched up by θ, the rear end of the run on the
ground, the edge meets the run H/sin θ ahead of it, and the machine goes over where its centre of mass is straight above
the edge or past it. Both are statics of the side view.

Assumptions: quasi-static, rigid ground and tracks, the edges of both tracks met at once; the tracks grip a step's face
and edge as hard as is needed. Tip-over angles: `stability`, over the corners of the flat runs.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
from scipy.optimize import minimize_scalar

from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_machine.drives import GearParams, MotorParams, SeriesMotorParams, geared_motor_of
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.supports import TrackEndParams, TrackParams


@dataclass(frozen=True, slots=True, eq=False)
class TrackedVehicle:
    """Two like tracks on a rigid hull, and the motor and gear of each."""

    mass: float
    """[kg]"""
    inertia: FloatArray
    """About roll, pitch and yaw, through the centre of mass, shape (3,) [kg m^2]."""
    ahead: float
    """Of the centre of mass before the middle of the flat runs [m]."""
    height: float
    """Of the centre of mass over the flat runs [m]."""
    clearance: float
    """Of the lowest pad over the flat runs; of the centre of mass where there are no pads [m]."""
    gauge: float
    """Between the middles of the tracks [m]."""
    track: TrackParams
    motor: MotorParams | SeriesMotorParams
    gear: GearParams
    bus_voltage: float
    """[V]"""
    controller_efficiency: float = 1.0

    def centred(self) -> "TrackedVehicle":
        """The same with its centre of mass over the middle of its runs."""
        return replace(self, ahead=0.0)

    @property
    def area(self) -> float:
        """Of both flat runs [m^2]."""
        return 2.0 * self.track.width * self.track.length

    @property
    def corners(self) -> FloatArray:
        """Of the flat runs, from the point of the ground under the centre of mass, shape (4, 2) [m]."""
        half, side = 0.5 * self.track.length, 0.5 * (self.gauge + self.track.width)
        return np.array([[end - self.ahead, edge] for end in (half, -half) for edge in (side, -side)])


def tracked_vehicle_of(
    machine: StandingMachine, bus_voltage: float, angles: Mapping[str, float] | None = None
) -> TrackedVehicle:
    """The vehicle of a machine of the plant, level.

    Args:
        bus_voltage: [V]. angles: of driven joints, as of a stowed arm; the others are at 0 [rad].

    Raises:
        InvalidValueError: not two like tracks beside one another, left and right.
    """
    tracks = machine.machine.tracks
    model, data = machine.model, machine.data
    configuration = machine.posture(angles)
    pin.ccrba(model, data, configuration, np.zeros(model.nv))
    inertia = np.array(data.Ig.inertia)
    centre = machine.centre_of_mass(configuration)
    places = np.array([machine.place(track.link, track.position) for track in tracks]).reshape(-1, 3)
    named_alike = [
        track.model_copy(update={"name": "", "joint": "", "link": "", "position": (0, 0, 0)}) for track in tracks
    ]
    alike = len(tracks) == 2 and named_alike[0] == named_alike[1]
    if not (alike and np.allclose(places[0, ::2], places[1, ::2]) and places[0, 1] != places[1, 1]):
        raise InvalidValueError("tracks", [track.name for track in tracks], "two alike, beside one another")
    pads = [machine.place(pad.link, pad.position)[2] - pad.radius for pad in machine.machine.pads]
    drive = geared_motor_of(machine.machine.drives, tracks[0].joint)
    middle = places.mean(axis=0)
    return TrackedVehicle(
        mass=machine.mass,
        inertia=np.diag(inertia).copy(),
        ahead=float(centre[0] - middle[0]),
        height=float(centre[2] - middle[2]),
        clearance=float(min(pads, default=centre[2]) - middle[2]),
        gauge=float(np.ptp(places[:, 1])),
        track=tracks[0],
        motor=drive.electric,
        gear=drive.transmission,
        bus_voltage=bus_voltage,
    )


def end_height(end: TrackEndParams) -> float:
    """Over the flat run, of where the belt is upright at one end [m]."""
    angle = math.radians(end.angle_deg)
    return end.length * math.sin(angle) + end.radius * math.cos(angle)


def balanced_step(vehicle: TrackedVehicle) -> float:
    """Highest edge on which the machine comes to balance as its tracks draw it up, met from ahead [m]."""
    lever = 0.5 * vehicle.track.length + vehicle.ahead

    def edge(pitch: float) -> float:
        return -math.sin(pitch) * (lever - vehicle.height * math.tan(pitch))

    found = minimize_scalar(edge, bounds=(0.0, math.atan2(lever, vehicle.height)), method="bounded")
    return -float(found.fun)


def highest_step(vehicle: TrackedVehicle) -> float:
    """[m]"""
    return min(end_height(vehicle.track.front), balanced_step(vehicle))


def widest_trench(vehicle: TrackedVehicle) -> float:
    """Whose far edge the flat run reaches before the centre of mass leaves the near one, forwards and backwards [m]."""
    return 0.5 * vehicle.track.length - abs(vehicle.ahead)
