"""The vehicle of the analysis from a machine of the plant: masses and inertias of the URDF, wheels and drives of its
parameters.

Inertias are those of the whole machine, joints at given angles, about its centre of mass (composite rigid body,
Featherstone 2008, sec. 6.2). Wheels within 5 cm of one another along x make an axle. A spring k or damper c on the
joint that carries a wheel is k/l^2, c/l^2 at the wheel, l = dz/dq its rise with the joint.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_analysis.vehicle.params import AxleParams, VehicleParams
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_machine.drives import geared_motor_of
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

SAME_AXLE = 0.05
"""Along x [m]."""


class BusSupply(NamedTuple):
    """Bus voltage [V], usable energy [Wh], power of all but the drives [W]."""

    voltage: float
    energy_wh: float
    house_power: float


def vehicle_of(
    name: str,
    machine: StandingMachine,
    supply: BusSupply,
    cruise_speed: float,
    angles: Mapping[str, float] | None = None,
) -> VehicleParams:
    """The vehicle of a machine on flat ground.

    Args:
        angles: of driven joints, as of a stowed arm; the others are at 0 [rad].

    Raises:
        InvalidValueError: wheels that do not make axles of two.
    """
    stance = machine.stand(lambda x, y: 0.0, angles=angles)
    model, data = machine.model, machine.data
    pin.ccrba(model, data, stance.configuration, np.zeros(model.nv))
    inertia = np.array(data.Ig.inertia)
    centre = machine.centre_of_mass(stance.configuration)
    groups: list[list[int]] = []
    for index in np.argsort(-stance.contacts[:, 0]):
        if groups and abs(stance.contacts[groups[-1][0], 0] - stance.contacts[index, 0]) < SAME_AXLE:
            groups[-1].append(int(index))
        else:
            groups.append([int(index)])
    wheels = machine.machine.wheels
    if any(len(group) != 2 for group in groups):
        raise InvalidValueError(
            "wheels", [wheel.name for wheel in wheels], "two of them beside one another, on each axle"
        )
    driven = {joint for drive in machine.machine.drives for joint in drive.joints}
    axles = []
    for group in groups:
        wheel = wheels[group[0]]
        joint = model.getJointId(wheel.joint)
        steer = 0.0
        if wheel.steer_joint is not None:
            place = model.joints[model.getJointId(wheel.steer_joint)].idx_q
            steer = min(abs(model.lowerPositionLimit[place]), abs(model.upperPositionLimit[place]))
        rate, damping, unsprung = _suspension(machine, stance.configuration, group[0])
        axles.append(
            AxleParams(
                spring_rate=rate,
                damping=damping,
                unsprung_mass=unsprung,
                name=wheel.name.rsplit("_", 1)[0],
                x=float(stance.contacts[group, 0].mean() - centre[0]),
                track=float(np.ptp(stance.contacts[group, 1])),
                wheel_radius=wheel.shear_radius,
                rim_radius=wheel.radius,
                grouser_count=wheel.grouser_count,
                wheel_width=wheel.width,
                wheel_inertia=float(model.inertias[joint].inertia[1, 1]),
                driven=wheel.joint in driven,
                max_steer=float(steer),
                contact=wheel.contact,
            )
        )
    drive = geared_motor_of(machine.machine.drives, wheels[0].joint)
    pads = [_pad_height(machine, index) for index, pad in enumerate(machine.machine.pads) if pad.link == "base_link"]
    return VehicleParams(
        name=name,
        citation="its URDF and YAML",
        mass=machine.mass,
        roll_inertia=float(inertia[0, 0]),
        pitch_inertia=float(inertia[1, 1]),
        yaw_inertia=float(inertia[2, 2]),
        height=float(centre[2]),
        clearance=max(min(pads), 1e-3) if pads else float(centre[2]),
        axles=tuple(axles),
        equalising=bool(machine.passive),
        motor=drive.electric,
        gear=drive.transmission,
        controller_efficiency=1.0,  # as in the plant, whose amplifiers lose nothing
        bus_voltage=supply.voltage,
        battery_energy_wh=supply.energy_wh,
        house_power=supply.house_power,
        cruise_speed=cruise_speed,
    )


def _suspension(machine: StandingMachine, configuration: FloatArray, wheel: int) -> tuple[float | None, float, float]:
    """Spring rate [N/m], damping [N s/m] and unsprung mass [kg] at a wheel; None, 0, 0 where no spring carries it."""
    model, data = machine.model, machine.data
    joint = machine.wheels[wheel]
    for carrier in list(model.supports[joint])[1:]:
        spring = machine.sprung.get(model.names[carrier])
        if spring is None:
            continue
        pin.computeJointJacobians(model, data, configuration)
        jacobian = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)
        lever = float(jacobian[2, model.joints[carrier].idx_v])
        mass = float(sum(model.inertias[part].mass for part in model.subtrees[carrier]))
        return spring.stiffness / lever**2, spring.damping / lever**2, mass
    return None, 0.0, 0.0


def _pad_height(machine: StandingMachine, index: int) -> float:
    """Of the lowest point of a pad over flat ground, at the last kinematics [m]."""
    pad = machine.machine.pads[index]
    return float(machine.place(pad.link, pad.position)[2] - pad.radius)
