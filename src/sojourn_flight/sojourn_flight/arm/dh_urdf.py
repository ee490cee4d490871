"""The text of a URDF from a Denavit-Hartenberg table.

With the product of dh.py, joint i is placed in link i-1 by  Tx(a_i-1) Rx(alpha_i-1) Tz(d_i) Rz(theta_i)  and moves
about (along) its z axis, in either convention: Rz(q) and Tz(d) commute. So link i of the URDF is frame i of the
modified convention; masses of a standard table are carried over by Tx(a_i) Rx(alpha_i).

Motor: URDF has `dynamics` (friction at the joint: that of the shaft times the gear ratio, viscous times its square)
and `transmission`, in which rotor inertia and gear ratio stand as in Drake's dialect of URDF. What URDF has no name
for is in attributes that other readers pass over: backward_friction, static_friction, stribeck_velocity.
"""

import math
from xml.sax.saxutils import escape

import numpy as np

from sojourn_flight.arm.dh import DhJoint, DhTable, DhTube, geometry_of, screw, twist
from sojourn_machine.params import FloatArray

_SHORTEST_TUBE = 1.0e-3
"""A shorter offset gets no shape [m]."""


def urdf_from_dh(table: DhTable, source: str) -> str:
    """The URDF of an arm.

    Args:
        source: where the table is and what it says of its own sources; goes into the header as a comment.
    """
    geometry = geometry_of(table)
    note = escape(source.strip()).replace("--", "- -")
    lines = [
        '<?xml version="1.0"?>',
        f"<!--\n{note}\n-->",
        f'<robot name="{table.name}" xmlns:drake="http://drake.mit.edu">',
        *_base(table),
    ]
    before = geometry.base
    for i, row in enumerate(table.joints):
        after = twist(geometry.a[i + 1], geometry.alpha[i + 1])
        place = before @ twist(geometry.a[i], geometry.alpha[i]) @ screw(0.0, geometry.d[i])
        place = place @ screw(geometry.theta[i], 0.0)
        in_link = after if table.convention == "standard" else np.eye(4)
        lines += _link(row, in_link, float(geometry.a[i + 1]))
        parent = "base_link" if i == 0 else _link_name(table.joints[i - 1])
        lines += _joint(row, parent, place)
        before = np.eye(4)
    tip = twist(geometry.a[-1], geometry.alpha[-1]) @ geometry.tool
    lines += [
        '  <link name="tip_link"/>',
        '  <joint name="tip_joint" type="fixed">',
        f'    <parent link="{_link_name(table.joints[-1])}"/><child link="tip_link"/>',
        f"    {_origin(tip)}",
        "  </joint>",
    ]
    for row in table.joints:
        lines += _transmission(row)
    return "\n".join([*lines, "</robot>", ""])


def _base(table: DhTable) -> list[str]:
    if not table.base_tubes:
        return ['  <link name="base_link"/>']
    shapes = [line for tube in table.base_tubes for line in _tube(tube, np.eye(4))]
    return ['  <link name="base_link">', *shapes, "  </link>"]


def _tube(tube: DhTube, transform_frame_to_link: FloatArray) -> list[str]:
    """The shape of a tube, twice: to be seen, and to collide."""
    rotation, shift = transform_frame_to_link[:3, :3], transform_frame_to_link[:3, 3]
    start, end = (rotation @ np.array(place) + shift for place in (tube.start, tube.end))
    length = float(np.linalg.norm(end - start))
    x, y, z = (end - start) / length
    across = math.hypot(x, y)
    turn = np.array([0.0, math.atan2(across, z), math.atan2(y, x) if across > 1e-9 else 0.0])
    at = f'<origin xyz="{_numbers(0.5 * (start + end))}" rpy="{_numbers(turn)}"/>'
    shape = f'<geometry><cylinder radius="{_number(tube.radius)}" length="{_number(length)}"/></geometry>'
    return [f"    <{what}>{at}{shape}</{what}>" for what in ("visual", "collision")]


def _link(row: DhJoint, transform_frame_to_link: FloatArray, length: float) -> list[str]:
    body, rotation = row.link, transform_frame_to_link[:3, :3]
    com = rotation @ np.array(body.com) + transform_frame_to_link[:3, 3]
    xx, yy, zz, xy, yz, xz = body.inertia
    tensor = rotation @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ rotation.T
    lines = [f'  <link name="{_link_name(row)}">']
    if body.mass > 0.0 or any(body.inertia):
        entries = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
        inertia = " ".join(f'{name}="{_number(tensor[at])}"' for name, at in entries.items())
        lines += [
            f'    <inertial><origin xyz="{_numbers(com)}"/><mass value="{_number(body.mass)}"/>',
            f"      <inertia {inertia}/></inertial>",
        ]
    if body.radius > 0.0 and abs(length) > _SHORTEST_TUBE:
        tube = f'<geometry><cylinder radius="{_number(body.radius)}" length="{_number(abs(length))}"/></geometry>'
        at = f'<origin xyz="{_number(0.5 * length)} 0 0" rpy="0 {_number(0.5 * math.pi)} 0"/>'
        lines += [f"    <{what}>{at}{tube}</{what}>" for what in ("visual", "collision")]
    for piece in body.tubes:
        lines += _tube(piece, transform_frame_to_link)
    return [*lines, "  </link>"]


def _joint(row: DhJoint, parent: str, place: FloatArray) -> list[str]:
    lower, upper = row.limits
    limit = {"lower": lower, "upper": upper, "effort": row.effort or 0.0, "velocity": row.velocity or 0.0}
    lines = [
        f'  <joint name="{row.name}" type="{row.kind}">',
        f'    <parent link="{parent}"/><child link="{_link_name(row)}"/>',
        f"    {_origin(place)}",
        '    <axis xyz="0 0 1"/>',
        "    <limit " + " ".join(f'{name}="{_number(value)}"' for name, value in limit.items()) + "/>",
    ]
    motor = row.motor
    if motor is not None:
        ratio = abs(motor.gear_ratio)
        values = {
            "damping": motor.viscous_friction * ratio**2,
            "friction": motor.coulomb_friction[0] * ratio,
            "backward_friction": motor.coulomb_friction[1] * ratio,
            "static_friction": motor.static_friction * ratio,
            "stribeck_velocity": motor.stribeck_velocity,
        }
        lines.append("    <dynamics " + " ".join(f'{name}="{_number(value)}"' for name, value in values.items()) + "/>")
    return [*lines, "  </joint>"]


def _link_name(row: DhJoint) -> str:
    return f"{row.name.removesuffix('_joint')}_link"


def _transmission(row: DhJoint) -> list[str]:
    if row.motor is None:
        return []
    return [
        f'  <transmission name="{row.name}_transmission">',
        "    <type>transmission_interface/SimpleTransmission</type>",
        f'    <joint name="{row.name}"/>',
        f'    <actuator name="{row.name}_motor">',
        f'      <drake:rotor_inertia value="{_number(row.motor.rotor_inertia)}"/>',
        f'      <drake:gear_ratio value="{_number(row.motor.gear_ratio)}"/>',
        "    </actuator>",
        "  </transmission>",
    ]


def _origin(place: FloatArray) -> str:
    r = place[:3, :3]
    across = math.hypot(r[0, 0], r[1, 0])
    pitch = math.atan2(-r[2, 0], across)
    if across > 1e-9:
        roll, yaw = math.atan2(r[2, 1], r[2, 2]), math.atan2(r[1, 0], r[0, 0])
    else:  # roll and yaw turn about the same axis: all of it is given to the roll
        roll, yaw = math.atan2(-r[1, 2], r[1, 1]), 0.0
    return f'<origin xyz="{_numbers(place[:3, 3])}" rpy="{_numbers(np.array([roll, pitch, yaw]))}"/>'


def _numbers(values: FloatArray) -> str:
    return " ".join(_number(value) for value in values)


def _number(value: float) -> str:
    """Shortest text of a number to 15 digits, and no minus zero."""
    text = f"{float(value):.15g}"
    return "0" if float(text) == 0.0 or abs(value) < 1e-15 else text
