"""Where a wheel meets the ground and how it moves there: the contact frame, penetration and velocities.

The rim is a circle of the wheel's radius in the plane across the axle. Its lowest point against the contact
plane (see `ground_plane`) lies below the plane by  z = r cos γ - d,  with the camber γ of the axle against
the ground and the distance d of the centre from the plane.

A rut lowers and tilts the plane (see `ground_memory`). It is nowhere above the ground as it was once, but the plane
through its edge is: so no wheel is deeper in a rut than it is below the ground as it was, or as a heap has made it,
whose top is taken to be twice as high as its mean round the contact.
"""

import math

from sojourn_machine.kernels import small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import MotionColumn, WheelColumn
from sojourn_physics.contact.ground_memory import RUT, Rim, look_ahead, settle_soil
from sojourn_physics.contact.ground_plane import blend_soils, contact_plane
from sojourn_physics.contact.tables import Body, Ground, Meeting

MIN_COS_CAMBER = 1e-3
"""A wheel that lies flatter than this on its side has no lowest point."""
HIGHEST_HEAP = 0.1
"""A wheel whose lowest point is so far above the ground as it was once may still stand on a heap of soil [m]."""


@small_kernel
def find_contact(
    wheel: FloatArray, body: Body, ground: Ground, travel: float, meeting: Meeting
) -> tuple[bool, int, bool]:
    """Contact of one wheel.

    Args:
        wheel: row of `WheelColumn`. travel: sense of travel D that the contact remembers. meeting: written.

    Returns:
        whether the wheel touches the ground, index of the soil with the largest share, and whether what is under it is
        on the map. Without contact only the last has a meaning.
    """
    centre, axle, velocity, angular_velocity = body.centre, body.axle, body.velocity, body.angular_velocity
    frame, motion, past = meeting.frame, meeting.motion, meeting.past
    radius = float(wheel[WheelColumn.RADIUS])
    # Forward is horizontal and in the wheel's plane; with the axle upright any direction will do.
    fx = axle[1]
    fy = -axle[0]
    horizontal = math.sqrt(fx * fx + fy * fy)
    if horizontal < 1e-6:
        fx, fy, horizontal = 1.0, 0.0, 1.0
    forward, up, in_plane = frame[0], frame[1], frame[2]
    along, side, normal = frame[3], frame[4], frame[5]
    forward[0] = fx / horizontal
    forward[1] = fy / horizontal
    forward[2] = 0.0
    up[0] = forward[1] * axle[2]
    up[1] = -forward[0] * axle[2]
    up[2] = forward[0] * axle[1] - forward[1] * axle[0]
    on_map: bool
    found, px, py, pz, slope_x, slope_y, on_map = contact_plane(ground, centre, forward, up, wheel, meeting.shares)
    if not found:
        return False, 0, on_map
    norm = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    remembers = ground.memory.place[2] > 0.0
    past[RUT] = 0.0
    deepest = math.inf
    if remembers:
        # lowest point and depth against the ground as it was once
        lowest_x = centre[0] + radius * slope_x * norm
        lowest_y = centre[1] + radius * slope_y * norm
        rise = centre[2] - pz - slope_x * (centre[0] - px) - slope_y * (centre[1] - py)
        depth = radius - rise * norm
        if depth > -HIGHEST_HEAP:
            lowered, lowered_x, lowered_y = look_ahead(
                ground.memory, wheel, Rim(lowest_x, lowest_y, forward[0], forward[1], travel, max(depth, 0.0)), past
            )
            pz -= lowered
            slope_x -= lowered_x
            slope_y -= lowered_y
            deepest = max(depth + 2.0 * max(-lowered, 0.0), 0.0)
            norm = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    normal[0] = -slope_x * norm
    normal[1] = -slope_y * norm
    normal[2] = norm

    camber = axle[0] * normal[0] + axle[1] * normal[1] + axle[2] * normal[2]
    for k in range(3):
        in_plane[k] = normal[k] - camber * axle[k]
        side[k] = axle[k] - camber * normal[k]
    cos_camber = math.sqrt(in_plane[0] ** 2 + in_plane[1] ** 2 + in_plane[2] ** 2)
    distance = normal[0] * (centre[0] - px) + normal[1] * (centre[1] - py) + normal[2] * (centre[2] - pz)
    penetration = min(radius * cos_camber - distance, deepest)
    if penetration <= 0.0 or cos_camber < MIN_COS_CAMBER:
        return False, 0, on_map
    for k in range(3):
        in_plane[k] /= cos_camber
        side[k] /= cos_camber
    along[0] = side[1] * normal[2] - side[2] * normal[1]
    along[1] = side[2] * normal[0] - side[0] * normal[2]
    along[2] = side[0] * normal[1] - side[1] * normal[0]

    spin = angular_velocity[0] * axle[0] + angular_velocity[1] * axle[1] + angular_velocity[2] * axle[2]
    motion[MotionColumn.PENETRATION] = penetration
    motion[MotionColumn.V_ALONG] = velocity[0] * along[0] + velocity[1] * along[1] + velocity[2] * along[2]
    motion[MotionColumn.V_SIDE] = velocity[0] * side[0] + velocity[1] * side[1] + velocity[2] * side[2]
    motion[MotionColumn.V_NORMAL] = velocity[0] * normal[0] + velocity[1] * normal[1] + velocity[2] * normal[2]
    motion[MotionColumn.RIM_SPEED] = radius * spin
    motion[MotionColumn.YAW_RATE] = (
        angular_velocity[0] * normal[0] + angular_velocity[1] * normal[1] + angular_velocity[2] * normal[2]
    )
    motion[MotionColumn.CAMBER] = camber
    motion[MotionColumn.ROLL_RATE] = (
        angular_velocity[0] * along[0] + angular_velocity[1] * along[1] + angular_velocity[2] * along[2]
    )
    soil_number = blend_soils(ground.soils, meeting.shares, wheel[WheelColumn.WIDTH], meeting.soil)
    if remembers:
        settle_soil(wheel, penetration, meeting.soil, past)
    return True, soil_number, on_map
