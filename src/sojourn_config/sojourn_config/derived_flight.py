"""What a machine's drive goes by where no file says it: from its size, its joints and its sensors.

Rules of thumb, in the proportions of the rovers that were tuned here. What depends on soil is a guess until
`scripts/tune` has measured it: its file, measured.yaml beside machine.yaml, comes before all that stands here.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from sojourn_config.derived import Derivation, DerivedValue
from sojourn_config.measured_file import UNMEASURED_SLIP
from sojourn_config.yaml_file import Data
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams, steering_geometry
from sojourn_flight.mobility.wheel_table import scrubs
from sojourn_machine.body import BodyLayout
from sojourn_machine.supports import TrackParams, WheelParams

GUESS = "a guess: scripts/tune measures it"
LENGTHS_A_SECOND = 0.3
"""Wheelbases that a rover drives in a second: the explorer 0.07, Lunokhod and the tracked rover 0.3, the lunar roving
vehicle 1 [1/s].
"""


class _Size(NamedTuple):
    """Of a machine that rolls [m]."""

    front: float
    rear: float
    half_width: float
    height: float
    """Of base_link above level ground."""
    wheelbase: float
    """From the first to the last axle; the flat run of tracks."""
    turn_radius: float
    """Of the farthest support."""
    radius: float
    """Of the smallest wheel."""
    step: tuple[float, str]
    """That it gets up, and from what that follows."""


def placeholders() -> Derivation:
    """What stands for all that cannot be derived of a machine whose wheels do not fit its URDF: it is refused for that,
    and not for keys that would follow.
    """
    size = _Size(1.0, 1.0, 0.5, 0.5, 1.0, 1.0, 0.2, (0.1, GUESS))
    mobility = dict.fromkeys(("max_wheel_rate", "lateral_weight", "max_steer_rate", "max_steer_acceleration"), 1.0)
    lengths = {
        key: 1.0 for key in ("max_curvature", "corner_cut", "lateral_length", "heading_length", "approach_speed")
    }
    known = {"mobility": {**mobility, "plausible_wheel_rate": 10.0}, "follower": lengths, "odometry": UNMEASURED_SLIP}
    return {
        "drive": {
            **{name: {key: DerivedValue(one, GUESS) for key, one in table.items()} for name, table in known.items()},
            "limits": dict(_limits(0.1, size)),
        }
    }


def derived_flight(layout: BodyLayout, sensors: Mapping[str, Data]) -> Derivation:
    """Keys of flight.yaml; none of a machine that does not roll. sensors: its sensors.yaml."""
    if not layout.machine.rolling:
        return {}
    geometry = steering_geometry(layout)
    size = _size_of(layout, geometry)
    fastest = _slowest(layout, [one.joint for one in layout.machine.rolling])
    drive: dict[str, DerivedValue | Derivation] = {
        "mobility": dict(_mobility(layout, geometry, fastest)),
        "odometry": {
            **{key: DerivedValue(value, GUESS) for key, value in UNMEASURED_SLIP.items()},
            "turn_sigma": _turn_sigma(geometry, size),
            "turn_drift_per_grade": _turn_drift(geometry, size),
        },
        "follower": dict(_following(geometry, size)),
    }
    if fastest is not None:
        speed = _rounded(min(0.8 * fastest * size.radius, LENGTHS_A_SECOND * size.wheelbase))
        drive["limits"] = dict(_limits(speed, size))
        drive["follower"] = {
            **dict(_following(geometry, size)),
            "approach_speed": DerivedValue(_rounded(0.2 * speed), f"a fifth of {speed:g} m/s"),
        }
    if sensor_of(sensors, "hazcam"):
        drive["obstacles"] = _passing(size)
    sun = sensor_of(sensors, "sun")
    if sun:
        drive["heading_fix"] = {
            f"{name}_sigma": DerivedValue(math.radians(float(degrees)), "the sun sensor of sensors.yaml")
            for name in ("noise", "misalignment")
            if isinstance(degrees := sun.get(f"{name}_deg"), int | float)
        }
    return {"drive": drive}


def sensor_of(sensors: Mapping[str, Data], kind: str) -> Mapping[str, Data]:
    """The table of the first sensor of a kind in a sensors.yaml; empty where there is none."""
    for name, table in sensors.items():
        if isinstance(table, Mapping) and table.get("kind", name) == kind:
            return table
    return {}


def _mobility(
    layout: BodyLayout, geometry: SteeringGeometryParams, fastest: float | None
) -> Iterator[tuple[str, DerivedValue]]:
    yield "kind", DerivedValue("rolling", "wheels or tracks of machine.yaml")
    if fastest is not None:
        yield "max_wheel_rate", DerivedValue(fastest, "velocity of the drive joints in the URDF")
        yield (
            "plausible_wheel_rate",
            DerivedValue(10.0 * fastest, "ten times the velocity of the drive joints in the URDF"),
        )
    slides = scrubs(geometry.wheels)
    why = "wheels slide sideways in every turn" if slides else "no wheel slides sideways by design"
    yield "lateral_weight", DerivedValue(0.1 if slides else 1.0, why)
    steering = _slowest(layout, layout.machine.steer_joints)
    if not layout.machine.steer_joints:
        yield "max_steer_rate", DerivedValue(1.0, "nothing steers")
        yield "max_steer_acceleration", DerivedValue(1.0, "nothing steers")
    elif steering is not None:
        rate = _rounded(0.85 * steering)
        yield "max_steer_rate", DerivedValue(rate, "0.85 of the velocity of the steering joints in the URDF")
        yield "max_steer_acceleration", DerivedValue(_rounded(rate / 0.3), f"{rate:g} rad/s after 0.3 s")


def _turn_sigma(geometry: SteeringGeometryParams, size: _Size) -> DerivedValue:
    """The skid rover, 0.60 m between its axles, is dragged back by 0.08 m in a turn of 0.8 rad; the explorer, all of
    whose wheels point along their ways, by 0.03 m in 0.6 rad, with 1.4 m.
    """
    part, why = (0.17, "wheels slide") if scrubs(geometry.wheels) else (0.035, "wheels roll")
    return DerivedValue(_rounded(part * size.wheelbase), f"{why} in a turn; wheelbase {size.wheelbase:.2f} m")


def _turn_drift(geometry: SteeringGeometryParams, size: _Size) -> DerivedValue:
    """The skid, micro and Lunokhod rovers, whose wheels slide in every turn, go down by 4.2, 4.3 and 3.1 of these radii
    on the sine of a slope; the explorer, whose wheels roll round, by 0.9, tracks by 0.7.
    """
    skids = scrubs(geometry.wheels) and not any(wheel.scrubs for wheel in geometry.wheels)
    part, why = (4.0, "wheels slide") if skids else (0.9, "wheels roll")
    radius = size.turn_radius
    return DerivedValue(_rounded(part * radius), f"{why} in a turn; farthest support {radius:.2f} m out; {GUESS}")


def _limits(speed: float, size: _Size) -> Iterator[tuple[str, DerivedValue]]:
    why = f"0.8 of the rim's at the velocity of the drive joints, {LENGTHS_A_SECOND:g} wheelbases a second at most"
    yield "max_speed", DerivedValue(speed, why)
    yaw_rate = _rounded(min(speed / size.turn_radius, 5.0))
    yield "max_yaw_rate", DerivedValue(yaw_rate, f"{speed:g} m/s at the farthest support, {size.turn_radius:.2f} m out")
    yield "max_acceleration", DerivedValue(min(speed, 0.3), "full speed after a second, 0.3 m/s^2 at most")
    yield "max_deceleration", DerivedValue(min(5.0 * speed, 0.5), "it stands after 0.2 s, 0.5 m/s^2 at most")


def _following(geometry: SteeringGeometryParams, size: _Size) -> Iterator[tuple[str, DerivedValue]]:
    why = f"in proportion to the wheelbase, {size.wheelbase:.2f} m"
    sharpest = (0.3 if scrubs(geometry.wheels) else 1.0) / size.wheelbase
    yield "max_curvature", DerivedValue(_rounded(min(sharpest, 20.0)), why)
    for key, part in (("corner_cut", 0.3), ("lateral_length", 0.6), ("heading_length", 0.3)):
        yield key, DerivedValue(_rounded(part * size.wheelbase), why)


def _passing(size: _Size) -> Derivation:
    places = "places of wheels and tracks"
    highest, why = size.step
    return {
        "outline": {
            "front": DerivedValue(_rounded(size.front), places),
            "rear": DerivedValue(_rounded(size.rear), places),
            "half_width": DerivedValue(_rounded(size.half_width), places),
            "ride_height": DerivedValue(_rounded(size.height), places),
        },
        "passable": {
            "max_step": DerivedValue(_rounded(highest), why),
            "clearance": DerivedValue(_rounded(0.5 * size.height), "half the height of base_link"),
        },
    }


def _size_of(layout: BodyLayout, geometry: SteeringGeometryParams) -> _Size:
    boxes = []
    for support in layout.machine.rolling:
        if isinstance(support, TrackParams):
            x, y, _ = layout.tracks[support.name].tolist()
            ends = [
                0.5 * support.length + end.length * math.cos(math.radians(end.angle_deg)) + end.radius
                for end in (support.front, support.rear)
            ]
            boxes.append((x + ends[0], x - ends[1], abs(y) + 0.5 * support.width))
        else:
            x, y, _ = layout.joints[support.joint].place.tolist()
            radius = support.shear_radius
            boxes.append((x + radius, x - radius, abs(y) + 0.5 * support.width))
    front, rear, side = np.array(boxes).T
    x = np.array([wheel.x for wheel in geometry.wheels])
    run = max((track.length for track in layout.machine.tracks), default=0.0)
    return _Size(
        front=max(float(front.max()), 1e-3),
        rear=max(float(-rear.min()), 1e-3),
        half_width=float(side.max()),
        height=max(layout.ride_height, 1e-3),
        wheelbase=max(float(np.ptp(x)), run, float(side.max())),
        turn_radius=max(math.hypot(wheel.x, wheel.y) for wheel in geometry.wheels),
        radius=min(wheel.radius for wheel in geometry.wheels),
        step=min(map(_highest_step, layout.machine.rolling)),
    )


def _highest_step(support: WheelParams | TrackParams) -> tuple[float, str]:
    """A wheel rolls up half its radius; the front of a track first runs up its incline, and then does as a wheel."""
    if not isinstance(support, TrackParams):
        return 0.5 * support.shear_radius, f"half the radius of the smallest wheel, {support.shear_radius:.3f} m"
    rises = [
        end.length * math.sin(math.radians(end.angle_deg)) + 0.5 * end.radius for end in (support.front, support.rear)
    ]
    return min(rises), "rise of the incline of the track, and half the radius of the wheel at its end"


def _slowest(layout: BodyLayout, joints: Sequence[str]) -> float | None:
    """The least limit of some joints' rates [rad/s]; None where one has none."""
    rates = [layout.joints[joint].velocity for joint in joints]
    return min(rates) if rates and all(map(math.isfinite, rates)) else None


def _rounded(value: float) -> float:
    """To two figures: it is a rule of thumb."""
    return float(f"{value:.2g}")
