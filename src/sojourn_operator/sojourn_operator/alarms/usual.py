"""The limits that come with a machine: they follow from its own parameters, as its computer knows them.

| alarm | from |
|---|---|
| tilt | static tip-over angle of the level machine over its wheels or tracks, arm stowed: 0.45, 0.6, 0.75 of it |
| slip, wheels, motors | the drive's own estimate of slip, its `wheels_in_trouble`, `failed_motors` |
| charge of each store | charges at which the power manager sheds its first and its last load |
| bus_voltage | where it limits the drive, and where the bus locks out |
| current and temperature of each store | its limits in power.yaml |
| drive, arm, power, roles | states and levels in which they say that something is wrong |

What is wrong in a simulated machine alone (rolled over, off the terrain) comes from the plant's heartbeat.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from sojourn_analysis.vehicle.stability import tip_over_margin
from sojourn_config.known_machine import KnownMachine
from sojourn_config.machine_body import STOWED
from sojourn_config.still_machine import StillMachine
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.stores import MAIN
from sojourn_machine.supports import TrackParams
from sojourn_operator.alarms.params import AlarmParams

ZERO_CELSIUS = 273.15
TILT_PARTS = {"watch": 0.45, "warning": 0.6, "critical": 0.75}
"""Of the angle at which it tips."""
ABOVE_SHEDDING = 0.05
"""Charge above the first threshold that is to be watched."""
COOL_DOWN = 5.0
"""Below the hottest temperature of a store, a warning [K]."""
NEARLY = 0.9
"""Part of a limit of current that is a warning."""


def usual_limits(known: KnownMachine) -> dict[str, AlarmParams]:
    """Alarms of a machine by name."""
    found = dict(_of_everybody())
    if known.driving is not None:
        found |= dict(_of_drive(known))
    if known.arm is not None:
        found |= dict(_of_arm())
    found |= dict(_of_power(known))
    return found


def tip_over_angle(known: KnownMachine) -> float:
    """Tilt at which the level machine, arm stowed, would tip over the nearest edge of its support [rad]."""
    still = StillMachine(known.urdf, known.arm_pose(STOWED))
    places = []
    for support in known.machine.rolling:
        if isinstance(support, TrackParams):
            for end in (0.5, -0.5):
                x, y, z = support.position
                places.append((still.place(support.link) @ [x + end * support.length, y, z, 1.0])[:3])
        else:
            places.append(still.place(known.urdf.joints[support.joint].child)[:3, 3] - [0.0, 0.0, support.radius])
    _, centre = still.weight_of(tuple(known.urdf.links))
    contacts = np.array(places)[None]
    return float(tip_over_margin(contacts, np.ones(contacts.shape[:2], dtype=bool), centre[None])[0])


def _alarm(field: str, **values: Any) -> AlarmParams:
    return AlarmParams.model_validate({"field": field, **values})


def _of_everybody() -> Iterator[tuple[str, AlarmParams]]:
    yield (
        "roles",
        _alarm("/diagnostics.state", critical={"equals": "stalled"}, help="waits for a message that stays away"),
    )
    yield "rolled_over", _alarm("/diagnostics.rolled over[plant]", critical={"equals": "true"})
    yield "off_the_terrain", _alarm("/diagnostics.off the terrain[plant]", critical={"equals": "true"})
    yield "lost_commands", _alarm("/diagnostics.lost commands[plant]", warning={"differs": ""}, latched=False)


def _of_drive(known: KnownMachine) -> Iterator[tuple[str, AlarmParams]]:
    tips = np.degrees(tip_over_angle(known))
    if np.isfinite(tips) and tips > 0.0:
        limits = {level: {"above": round(part * tips, 1)} for level, part in TILT_PARTS.items()}
        yield "tilt", _alarm(
            "/odom.pose.pose.orientation.tilt_deg", **limits, hysteresis=0.5, persistence_s=0.2,
            help=f"it tips over at {tips:.0f} degrees",
        )  # fmt: skip
    if getattr(known.drive.mobility, "slip", None) is not None:
        yield from _of_slip()
    yield "motors", _alarm("/drive/status.failed_motors", warning={"differs": ""}, help="found out by the drive")
    yield "drive", _alarm(
        "/drive/status.state", watch={"equals": ["stopped", "refused"]}, warning={"equals": "failed"}, latched=False,
        help="see its reason",
    )  # fmt: skip


def _of_slip() -> Iterator[tuple[str, AlarmParams]]:
    """Of a drive that estimates it."""
    yield "slip", _alarm(
        "/drive/status.slip", watch={"above": 0.4, "below": -0.4}, warning={"above": 0.6, "below": -0.6},
        critical={"above": 0.9}, hysteresis=0.05, persistence_s=8.0, latched=False,
        help="the wheels turn without headway",
    )  # fmt: skip
    yield "wheels", _alarm(
        "/drive/status.wheels_in_trouble", watch={"differs": ""}, persistence_s=3.0, latched=False,
        help="idle, blocked or spinning",
    )  # fmt: skip


def _of_arm() -> Iterator[tuple[str, AlarmParams]]:
    yield "arm", _alarm(
        "/arm/status.state", watch={"equals": ["stopped", "refused"]}, warning={"equals": "failed"}, latched=False,
        help="see its reason",
    )  # fmt: skip


def _of_power(known: KnownMachine) -> Iterator[tuple[str, AlarmParams]]:
    manager, law = known.power_manager, known.power_manager.law
    stores = known.power.all_stores
    thresholds = manager.shed_thresholds or (law.shed_soc_first,)
    for place, (name, store) in enumerate(stores.items()):
        end = "" if place == 0 else f"_{name}"
        topic = "" if place == 0 else f"/{name}"
        yield f"charge{end}", _alarm(
            f"/battery_state{topic}.percentage", watch={"below": round(thresholds[0] + ABOVE_SHEDDING, 4)},
            warning={"below": round(thresholds[0], 4)}, critical={"below": round(thresholds[-1], 4)},
            hysteresis=round(0.5 * law.shed_soc_hysteresis, 4), persistence_s=2.0,
            help=f"loads are shed from {thresholds[0]:.0%} on",
        )  # fmt: skip
        if isinstance(store, BatteryParams):
            yield from _of_battery(store, end, topic)
    first = next(iter(stores.values()), None)
    lockout = known.power.bus.lockout_voltage
    if first is not None and first.bus == MAIN and lockout is not None:
        yield "bus_voltage", _alarm(
            "/bus/state.voltage", watch={"below": law.derate_start_voltage}, warning={"below": law.derate_stop_voltage},
            critical={"below": round(1.02 * lockout, 2)}, hysteresis=0.2, persistence_s=2.0,
            help=f"the bus locks out at {lockout:g} V",
        )  # fmt: skip
    yield "power", _alarm("/power/status.faults", warning={"differs": ""}, help="found out by the power manager")
    yield "shedding", _alarm("/power/status.state", watch={"equals": "shedding"}, latched=False, persistence_s=3.0)


def _of_battery(store: BatteryParams, end: str, topic: str) -> Iterator[tuple[str, AlarmParams]]:
    most, charging = (
        limit * store.cells_parallel for limit in (store.discharge_current_limit, store.charge_current_limit)
    )
    charge_limits: Mapping[str, float] = {"above": round(1.05 * charging, 2)} if charging > 0.0 else {}
    yield f"current{end}", _alarm(
        f"/bus/state{topic}.current", warning={"below": round(-NEARLY * most, 2)},
        critical={"below": round(-1.05 * most, 2), **charge_limits}, hysteresis=round(0.02 * most, 2),
        persistence_s=2.0,
        help=f"at most {most:g} A out, {charging:g} A in",
    )  # fmt: skip
    hot, cold = store.temperature_max - ZERO_CELSIUS, store.temperature_discharge_min - ZERO_CELSIUS
    yield f"temperature{end}", _alarm(
        f"/battery_state{topic}.temperature",
        warning={"above": round(hot - COOL_DOWN, 1), "below": round(cold + COOL_DOWN, 1)},
        critical={"above": round(hot, 1), "below": round(cold, 1)}, hysteresis=0.5, persistence_s=5.0,
        help=f"between {cold:.0f} and {hot:.0f} degrees Celsius",
    )  # fmt: skip
