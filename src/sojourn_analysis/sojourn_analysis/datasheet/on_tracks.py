"""The data sheet of a machine on two tracks."""

import math
from dataclasses import dataclass

import numpy as np

from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.motors import motors_of
from sojourn_analysis.datasheet.standing import tip_over_angles
from sojourn_analysis.vehicle.driveline import largest_wheel_torque, motor_point
from sojourn_analysis.vehicle.stability import tip_over_margin
from sojourn_analysis.vehicle.track_traction import (
    LARGEST_LEAN,
    TrackGround,
    footing,
    greatest_grade,
    pull,
    slip_on,
    steady_climb,
    thrust,
)
from sojourn_analysis.vehicle.track_turning import TrackTurn, friction, sliding_moment, steady_turn
from sojourn_analysis.vehicle.tracked_vehicle import (
    TrackedVehicle,
    balanced_step,
    end_height,
    highest_step,
    widest_trench,
)
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.soil.params import SoilParams, kernel_table

SLIPS = np.linspace(0.0, 0.8, 81)
PULLING_SLIP = 0.2
"""At which drawbar pulls are compared (Wong 2008, Theory of Ground Vehicles, sec. 2.4)."""
GRADES_DEG = np.arange(0.0, 41.0, 1.0)
RADII = np.concatenate([[0.0], np.geomspace(0.05, 20.0, 50)])


@dataclass(frozen=True, slots=True, eq=False)
class TrackedSubject:
    """A machine on tracks, where it is, and how it is driven: speed [m/s], yaw rate on the spot [rad/s]."""

    machine: StandingMachine
    vehicle: TrackedVehicle
    soil: SoilParams
    body: BodyParams
    cruise_speed: float
    yaw_rate: float

    @property
    def ground(self) -> TrackGround:
        """The vehicle on its soil."""
        return TrackGround(self.vehicle, kernel_table([self.soil])[0], self.body.surface_gravity)


def tracked_sections(subject: TrackedSubject) -> tuple[Section, ...]:
    """All of them.

    Raises:
        InvalidValueError: rock, which the law of tracks does not know, or a soil on which it cannot drive or turn.
    """
    if subject.soil.kind == "rigid":
        raise InvalidValueError("soil", subject.soil.name, "one that gives way: tracks are taken on soil")
    motors = motors_of(subject.machine.machine.drives, subject.vehicle.bus_voltage)
    return (general(subject), standing(subject), traction(subject), climbing(subject), turning(subject), motors)


def general(subject: TrackedSubject) -> Section:
    """Sizes and masses."""
    vehicle, track = subject.vehicle, subject.vehicle.track
    roll, pitch, yaw = (float(value) for value in vehicle.inertia)
    return Section(
        "Vehicle",
        (
            Figure("mass", "Mass", vehicle.mass, "kg"),
            Figure("weight", "Weight here", subject.ground.weight, "N"),
            Figure("gauge", "Gauge, between the middles of the tracks", vehicle.gauge, "m"),
            Figure("track_length", "Flat run of a track", track.length, "m"),
            Figure("track_width", "Width of a track", track.width, "m"),
            Figure("length_over_gauge", "Flat run over gauge", track.length / vehicle.gauge, ""),
            Figure("sprocket_radius", "Radius of a sprocket, outside of the links", track.radius, "m"),
            Figure("centre_of_mass_height", "Height of the centre of mass", vehicle.height, "m"),
            Figure("centre_of_mass_ahead", "Centre of mass before the middle of the runs", vehicle.ahead, "m"),
            Figure("clearance", "Ground clearance", vehicle.clearance, "m"),
            Figure("roll_inertia", "Moment of inertia, roll", roll, "kg m²"),
            Figure("pitch_inertia", "Moment of inertia, pitch", pitch, "kg m²"),
            Figure("yaw_inertia", "Moment of inertia, yaw", yaw, "kg m²"),
        ),
    )


def standing(subject: TrackedSubject) -> Section:
    """Tip-over angles, the highest step, the widest trench."""
    vehicle = subject.vehicle
    directions = np.linspace(0.0, 2.0 * math.pi, 181)
    angles = np.degrees(tip_over_angles(vehicle.corners, vehicle.height, directions))
    contacts = np.column_stack([vehicle.corners, np.zeros(4)])
    margin = tip_over_margin(contacts[None], np.ones((1, 4), bool), np.array([[0.0, 0.0, vehicle.height]]))
    named = (("forward", "ahead", 0), ("left", "to the left", 45), ("backward", "behind", 90))
    figures = [
        *(
            Figure(f"tip_over_{key}", f"Tip-over angle, downhill is {words}", float(angles[i]), "°")
            for key, words, i in named
        ),
        Figure("tip_over_least", "Tip-over angle, least of all directions", math.degrees(float(margin[0])), "°"),
        Figure("highest_step", "Highest step", highest_step(vehicle), "m", "the lesser of the next two"),
        Figure(
            "front_height", "Height at which the front of the belt is upright", end_height(vehicle.track.front), "m"
        ),
        Figure("balanced_step", "Highest edge over which the machine balances", balanced_step(vehicle), "m"),
        Figure("widest_trench", "Widest trench", widest_trench(vehicle), "m", "flat run past the centre of mass"),
    ]
    curve = Curve(
        "Tip-over angle by the direction of the slope",
        "direction downhill, from forward to the left [°]",
        "angle [°]",
        {"corners of the flat runs": (np.degrees(directions), angles)},
    )
    text = (
        "On rigid ground, quasi-static. A step is met square by both tracks, which grip its face and edge as hard as "
    )
    return Section("Standing", tuple(figures), (curve,), text + "is needed; a trench has edges that do not give way.")


def traction(subject: TrackedSubject) -> Section:
    """Ground pressure, sinkage, resistances and pull on the level."""
    ground, track = subject.ground, subject.vehicle.track
    level = footing(ground)
    own = np.array([thrust(ground, level, float(slip)) for slip in SLIPS])
    resistance = level.compaction + level.bulldozing
    best = pull(ground, float(SLIPS[-1]))
    figures = (
        Figure("ground_pressure", "Mean ground pressure", ground.weight / subject.vehicle.area / 1000.0, "kPa"),
        Figure("greatest_pressure", "Greatest ground pressure", float(level.pressure.max()) / 1000.0, "kPa"),
        Figure("sinkage", "Sinkage, greatest", 1000.0 * level.depth, "mm", _in_range(level.depth, track.width)),
        Figure("compaction_resistance", "Resistance of compaction", level.compaction, "N"),
        Figure("bulldozing_resistance", "Resistance of soil pushed ahead", level.bulldozing, "N"),
        Figure("pull", "Drawbar pull", pull(ground, PULLING_SLIP), "N", f"slip {PULLING_SLIP:g}"),
        Figure("pull_coefficient", "The same over the weight", pull(ground, PULLING_SLIP) / ground.weight),
        Figure("greatest_pull", "Greatest drawbar pull", best, "N", f"slip {SLIPS[-1]:g}"),
    )
    place = track.length * (0.5 - (np.arange(len(level.pressure)) + 0.5) / len(level.pressure))
    curves = (
        Curve(
            "Both tracks on the level",
            "slip",
            "force [N]",
            {"thrust": (SLIPS, own), "drawbar pull": (SLIPS, own - resistance)},
        ),
        Curve(
            "Ground pressure",
            "before the middle of the run [m]",
            "pressure [kPa]",
            {"": (place, level.pressure / 1000.0)},
        ),
    )
    text = f"Soil {subject.soil.name} on {subject.body.name}, level; Bekker's pressure, Janosi's shear over the length."
    return Section("Ground pressure and traction", figures, curves, text)


def climbing(subject: TrackedSubject) -> Section:
    """Grades, and what driving straight takes."""
    ground, speed = subject.ground, subject.cruise_speed
    steepest, limit = greatest_grade(ground, speed)
    level = steady_climb(ground, speed)
    slips, powers = [], []
    for grade in np.radians(GRADES_DEG):
        possible = (
            abs(subject.vehicle.ahead - subject.vehicle.height * math.tan(grade))
            < LARGEST_LEAN * subject.vehicle.track.length
        )
        steady = steady_climb(ground, speed, float(grade)) if possible else None
        slips.append(math.nan if steady is None else steady.slip)
        powers.append(math.nan if steady is None or not steady.feasible else steady.power)
    figures = (
        Figure("greatest_grade", "Steepest grade", math.degrees(steepest), "°", limit),
        Figure("level_slip", "Slip on the level", None if level is None else level.slip),
        Figure("slip_15", "Slip on 15°", slip_on(ground, math.radians(15.0))),
        Figure(
            "drive_energy", "Energy of the motors on the level", None if level is None else level.power / speed, "J/m"
        ),
    )
    curves = (
        Curve("Slip on a grade", "grade [°]", "slip", {"": (GRADES_DEG, np.array(slips))}),
        Curve("Power of the motors on a grade", "grade [°]", "power [W]", {"": (GRADES_DEG, np.array(powers))}),
    )
    text = (
        f"At {speed:g} m/s, straight up. The load leans to the rear as the grade says, and its rear end sinks deeper."
    )
    return Section("Climbing", figures, curves, text)


def turning(subject: TrackedSubject) -> Section:
    """Moment and power over the radius."""
    ground, vehicle, rate = subject.ground, subject.vehicle, subject.yaw_rate
    rates = np.minimum(rate, subject.cruise_speed / np.maximum(RADII, 1e-9))
    turns = [steady_turn(ground, float(r), float(radius)) for r, radius in zip(rates, RADII, strict=True)]
    spot = turns[0]
    moments = np.array([turn.moment for turn in turns])
    figures = (
        Figure("sliding_friction", "Friction of soil that slides", friction(ground)),
        Figure(
            "steeds_moment",
            "Moment that resists a turn, all of the runs sliding",
            sliding_moment(ground),
            "N m",
            "μWl/4",
        ),
        Figure(
            "spin_moment", "Moment that resists a turn on the spot", spot.moment, "N m", "shear grows over the length"
        ),
        Figure("spin_torque", "Torque of a sprocket for it", float(spot.thrusts[1]) * vehicle.track.radius, "N m"),
        Figure("spin_torque_available", "Torque that a motor gives then", _available(vehicle, spot), "N m"),
        Figure("spin_power", "Power of both sprockets for it", spot.power, "W"),
        Figure("spin_bus_power", "Power of both motors for it", _bus_power(vehicle, spot), "W"),
        Figure("width_ratio", "Effective over built gauge", float(np.ptp(spot.belts)) / rate / vehicle.gauge, ""),
    )
    lines = {"slip of both tracks": (RADII, moments), "μWl/4": (RADII, np.full(len(RADII), sliding_moment(ground)))}
    abscissa = "radius of the middle of the machine [m]"
    powers = {
        "sprockets": (RADII, np.array([turn.power for turn in turns])),
        "motors": (RADII, np.array([_bus_power(vehicle, turn) for turn in turns])),
    }
    curves = (
        Curve("Moment that resists a turn", abscissa, "moment [N m]", lines),
        Curve("Power of a turn", abscissa, "power [W]", powers),
    )
    text = (
        f"Level ground, low speed: {rate:g} rad/s, and {subject.cruise_speed:g} m/s in wide turns. Nothing is pushed "
        "aside by the flanks of the tracks. Shear forgets its direction here; with it, in the plant, less resists."
    )
    return Section("Turning", figures, curves, text)


def _in_range(depth: float, width: float) -> str:
    return "" if depth < 0.25 * width else "beyond a quarter of the width: out of the law's range"


def _available(vehicle: TrackedVehicle, turn: TrackTurn) -> float:
    return largest_wheel_torque(vehicle, abs(float(turn.belts[1])) / vehicle.track.radius)


def _bus_power(vehicle: TrackedVehicle, turn: TrackTurn) -> float:
    """Of both motors; what one feeds back the other uses [W]."""
    radius, total = vehicle.track.radius, 0.0
    for belt, force in zip(turn.belts, turn.thrusts, strict=True):
        sense = math.copysign(1.0, belt)
        total += motor_point(vehicle, float(sense * force) * radius, abs(float(belt)) / radius).power
    return total
