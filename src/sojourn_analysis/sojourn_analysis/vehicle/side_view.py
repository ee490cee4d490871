"""The left half of a machine seen from the side, from its URDF: what `step_climbing` needs.

A passive joint without a coupling that carries two wheels is a bogie; coupled passive joints (rockers) do not turn
while both sides are alike. Masses are halved, so the machine must be the same on both sides; links that are not (an
arm, a mast) count half on each.
"""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from sojourn_analysis.vehicle.step_climbing import SideView, SideWheel
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


def side_view(machine: StandingMachine, angles: Mapping[str, float] | None = None) -> SideView:
    """The left side on flat ground, driven joints at `angles` or 0 [rad]; x forward of base_link.

    Raises:
        InvalidValueError: wheels or bogies that this view has no place for.
    """
    stance = machine.stand(lambda x, y: 0.0, angles=angles)
    model, data = machine.model, machine.data
    pin.forwardKinematics(model, data, stance.configuration)
    base = data.oMi[1]
    coupled = {name for coupling in machine.machine.couplings for name in (coupling.first, coupling.second)}
    bogies = [model.getJointId(name) for name in machine.passive if name not in coupled]
    left = [i for i, joint in enumerate(machine.wheels) if base.actInv(data.oMi[joint].translation)[1] > 0.0]
    hinge = {i: next((b for b in bogies if b in list(model.supports[machine.wheels[i]])), None) for i in left}
    used = {bogie for bogie in hinge.values() if bogie is not None}
    names = [wheel.name for wheel in machine.machine.wheels]
    if len(used) > 1 or 2 * len(left) != len(machine.wheels):
        raise InvalidValueError("machine", names, "one bogie a side at most")
    if not used and len(left) != 2:
        raise InvalidValueError("machine", names, "two wheels a side on the body, where there is no bogie")
    wheels = []
    for i in left:
        place = data.oMi[machine.wheels[i]].translation
        wheels.append(SideWheel(float(place[0]), float(place[2]), float(machine.radii[i]), hinge[i] is not None))
    order = sorted(range(len(left)), key=lambda k: -wheels[k].x)
    drives = {name: drive for drive in machine.machine.drives for name in drive.joints}
    torque = min(drive.largest_torque for drive in (drives[machine.machine.wheels[i].joint] for i in left))
    all_bogies = [bogie for bogie in bogies if any(bogie in list(model.supports[w]) for w in machine.wheels)]
    hinged_mass, hinged_moment = _mass_of(machine, all_bogies)
    centre = machine.mass * machine.centre_of_mass(stance.configuration) - hinged_moment
    body = 0.5 * (machine.mass - hinged_mass)
    belly = _belly(machine)
    if not used:
        sizes = tuple(wheels[k] for k in order)
        return SideView(body, _plane(centre / (2.0 * body)), sizes, max_torque=torque, belly=belly)
    bogie = used.pop()
    mass, moment = _mass_of(machine, [bogie])
    joint = model.joints[bogie]
    limit = min(abs(model.lowerPositionLimit[joint.idx_q]), abs(model.upperPositionLimit[joint.idx_q]))
    return SideView(
        body,
        _plane(centre / (2.0 * body)),
        tuple(wheels[k] for k in order),
        mass,
        _plane(moment / mass),
        _plane(data.oMi[bogie].translation),
        float(limit),
        torque,
        belly,
    )


def _belly(machine: StandingMachine) -> tuple[float, float, float] | None:
    """Rear and front end and height of the underside that the pads of base_link span [m]; None without such pads."""
    places = []
    for pad in machine.machine.pads:
        if pad.link == "base_link":
            frame = machine.model.frames[machine.model.getFrameId(pad.link)]
            place = machine.data.oMi[frame.parentJoint].act(frame.placement.act(np.array(pad.position)))
            places.append((place[0] - pad.radius, place[0] + pad.radius, place[2] - pad.radius))
    if not places:
        return None
    ends = np.array(places)
    return float(ends[:, 0].min()), float(ends[:, 1].max()), float(ends[:, 2].min())


def _mass_of(machine: StandingMachine, roots: list[int]) -> tuple[float, FloatArray]:
    """Mass [kg] and first moment [kg m] in the world of what hangs on some joints, at the last kinematics."""
    mass, moment = 0.0, np.zeros(3)
    for joint in range(1, machine.model.njoints):
        if any(root in list(machine.model.supports[joint]) for root in roots):
            inertia = machine.model.inertias[joint]
            mass += float(inertia.mass)
            moment += inertia.mass * machine.data.oMi[joint].act(inertia.lever)
    return mass, moment


def _plane(point: FloatArray) -> tuple[float, float]:
    return float(point[0]), float(point[2])
