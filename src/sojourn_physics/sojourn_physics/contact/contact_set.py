"""All supports of a machine on the ground, in one call: each kind by its own geometry and law."""

from sojourn_machine.kernels import kernel
from sojourn_physics.contact.feet import feet_on_ground
from sojourn_physics.contact.pads import pads_on_ground
from sojourn_physics.contact.tables import Ground, Kinematics, Supports, Touch
from sojourn_physics.contact.tracks import tracks_on_ground
from sojourn_physics.contact.wheels import wheels_on_ground


@kernel
def contact_forces(supports: Supports, ground: Ground, machine: Kinematics, dt: float, touch: Touch) -> bool:
    """Forces of all supports, as one generalised force.

    Returns:
        whether every support is on the map.
    """
    on_map: bool = wheels_on_ground(supports.wheels, ground, machine, dt, touch)
    on_map &= tracks_on_ground(supports.tracks, ground, machine, dt, touch)
    on_map &= feet_on_ground(supports.feet, ground, machine, dt, touch)
    on_map &= pads_on_ground(supports.pads, ground, machine, dt, touch)
    return on_map
