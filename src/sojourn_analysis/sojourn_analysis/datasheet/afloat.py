"""An arm on a base that floats free: how the base gives way, and what the arm is worth against the stars."""

import numpy as np
import pinocchio as pin

from sojourn_analysis.arm.free_flying import free_flying_arm, manipulability
from sojourn_analysis.datasheet.figures import Figure, Section
from sojourn_machine.params import FloatArray


def afloat(urdf_xml: str, tip: str, postures: dict[str, dict[str, float]]) -> Section:
    """Figures of a spacecraft.

    Args:
        tip: link at the arm's end. postures: joints by name [rad or m], by the name of the posture.
    """
    model = pin.buildModelFromXML(urdf_xml, pin.JointModelFreeFlyer())
    mass = sum(inertia.mass for inertia in model.inertias)
    base = model.inertias[1].mass
    figures = [
        Figure("mass", "Mass of all", mass, "kg"),
        Figure("base_mass_share", "Share of the base in it", base / mass),
    ]
    for name, joints in postures.items():
        found = free_flying_arm(model, _at(model, joints), tip)
        share = manipulability(found.generalised_jacobian) / manipulability(found.fixed_jacobian)
        figures.append(Figure(f"worth_{name}", f"Manipulability of what it has on a fixed base, {name}", share))
        names = [joint for joint in model.names[2:] if joint in joints]
        for joint in names:
            column = model.joints[model.getJointId(joint)].idx_v - 6
            moved, turned = found.reaction[:3, column], found.reaction[3:, column]
            label = joint.removesuffix("_joint").replace("_", " ")
            figures += [
                Figure(
                    f"base_turn_{name}_{joint}",
                    f"Turn of the base for a turn of {label}, {name}",
                    float(np.linalg.norm(turned)),
                ),
                Figure(
                    f"base_way_{name}_{joint}",
                    f"Way of the base for a radian of {label}, {name}",
                    1000.0 * float(np.linalg.norm(moved)),
                    "mm",
                ),
            ]
    text = "Total momentum zero (Umetani and Yoshida 1989); manipulability: product of the singular values."
    return Section("Reaction of the base", tuple(figures), (), text)


def _at(model: pin.Model, joints: dict[str, float]) -> FloatArray:
    configuration = pin.neutral(model)
    for name, position in joints.items():
        configuration[model.joints[model.getJointId(name)].idx_q] = position
    return np.asarray(configuration)
