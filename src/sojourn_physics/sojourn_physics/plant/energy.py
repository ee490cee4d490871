"""Energy of the moving machine: of its links, of the rotors that turn in it, and of its springs."""

from typing import TYPE_CHECKING

import pinocchio as pin

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_physics.actuators.joint_drive import ANGLE, MOTOR_RATE, SPRING_REST, SPRING_STIFFNESS

if TYPE_CHECKING:
    from sojourn_physics.plant.model import PlantModel


def mechanical_energy(
    model: "PlantModel", configuration: FloatArray, velocity: FloatArray, joints: FloatArray
) -> float:
    """Kinetic energy, turning rotors included, potential energy over z = 0, and what the springs hold [J].

    Args:
        configuration, velocity: of the machine, (nq,), (nv,). joints: (STATE_ROWS, joints), see `joint_drive`.
    """
    table = model.joints
    links = pin.computeKineticEnergy(model.multibody, model.data, configuration, velocity)
    height = _potential_energy(model, configuration)
    return float(links + height + _of_joints(velocity, joints, table.armature, table.rotors, table.parameters))


def _potential_energy(model: "PlantModel", configuration: FloatArray) -> float:
    """Over z = 0; in gravity that is not the same everywhere, over the machine drawn together in the origin of map,
    its links as far from its base as they are but in the base's gravity [J].
    """
    if model.field.uniform and model.air is None:
        return float(pin.computePotentialEnergy(model.multibody, model.data, configuration))
    base = configuration[:3]
    reach = model.centre_of_mass(configuration) - base
    return model.mass * float(model.field.potential(base) - model.field.acceleration(base) @ reach)


@njit(cache=True)
def _of_joints(
    velocity: FloatArray, joints: FloatArray, armature: FloatArray, rotors: FloatArray, parameters: FloatArray
) -> float:
    """Of rotors that turn with their links, (nv,), of those with play in their gear, (joints,), and of springs [J]."""
    energy = 0.0
    for i in range(velocity.shape[0]):
        energy += armature[i] * velocity[i] ** 2
    for i in range(joints.shape[1]):
        energy += rotors[i] * joints[MOTOR_RATE, i] ** 2
        stretch = joints[ANGLE, i] - parameters[i, SPRING_REST]
        energy += parameters[i, SPRING_STIFFNESS] * stretch**2
    return 0.5 * energy
