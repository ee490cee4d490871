"""Supports as bodies of the machine: where they are, how they move, and their forces as generalised ones."""

from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.kernels import small_kernel
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.contact.contact_law import OutColumn
from sojourn_physics.contact.tables import Body, Carried, Kinematics


@small_kernel
def place_body(carried: Carried, i: int, placements: FloatArray, body: Body) -> None:
    """Centre and axle of a support's body, from the placement of the joint that carries it."""
    joint = placements[carried.bodies[i]]
    for k in range(3):
        body.centre[k] = joint[9 + k]
        for j in range(3):
            body.centre[k] += joint[3 * j + k] * carried.offsets[i, j]
        body.axle[k] = joint[3 + k]


@small_kernel
def move_point(twist: FloatArray, centre: FloatArray, velocity: FloatArray) -> None:
    """Velocity of a point of a body, (3,), written, from the twist (6,) of its point at the map's origin."""
    velocity[0] = twist[0] + twist[4] * centre[2] - twist[5] * centre[1]
    velocity[1] = twist[1] + twist[5] * centre[0] - twist[3] * centre[2]
    velocity[2] = twist[2] + twist[3] * centre[1] - twist[4] * centre[0]


@small_kernel
def move_body(chain: IntArray, machine: Kinematics, twist: FloatArray, body: Body) -> None:
    """Velocities of a support's body. twist: (6,), written: those of the point of the body at the map's origin."""
    twist[:] = 0.0
    for column in chain:
        if column < 0:
            break
        for k in range(6):
            twist[k] += machine.jacobian[k, column] * machine.velocity[column]
    move_point(twist, body.centre, body.velocity)


@small_kernel
def add_force(chain: IntArray, jacobian: FloatArray, centre: FloatArray, wrench: FloatArray, force: FloatArray) -> None:
    """Add a wrench at a point to the generalised force; `wrench` is left with its moment about the map's origin."""
    wrench[3] += centre[1] * wrench[2] - centre[2] * wrench[1]
    wrench[4] += centre[2] * wrench[0] - centre[0] * wrench[2]
    wrench[5] += centre[0] * wrench[1] - centre[1] * wrench[0]
    for column in chain:
        if column < 0:
            break
        for k in range(6):
            force[column] += jacobian[k, column] * wrench[k]


@small_kernel
def wrench_in_map(out: FloatArray, frame: FloatArray, body: Body, wrench: FloatArray) -> None:
    """Force and moment at a support's point in map, from its law's answer; writes the power that they take from it."""
    along, side, normal = frame[3], frame[4], frame[5]
    power = 0.0
    for k in range(3):
        wrench[k] = (
            out[OutColumn.FORCE_X] * along[k] + out[OutColumn.FORCE_Y] * side[k] + out[OutColumn.FORCE_Z] * normal[k]
        )
        moment = (
            out[OutColumn.MOMENT_X] * along[k] + out[OutColumn.MOMENT_Y] * side[k] + out[OutColumn.MOMENT_Z] * normal[k]
        )
        wrench[3 + k] = moment - out[OutColumn.TORQUE] * body.axle[k]
        power -= wrench[k] * body.velocity[k] + wrench[3 + k] * body.angular_velocity[k]
    out[OutColumn.POWER] = power


@small_kernel
def tell(out: FloatArray, wrench: FloatArray, soil_number: int, report: FloatArray) -> None:
    """What a support does, from its law's answer; the place is told already."""
    report[ReportColumn.SINKAGE] = out[OutColumn.SINKAGE]
    report[ReportColumn.SLIP_RATIO] = out[OutColumn.SLIP_RATIO]
    report[ReportColumn.SLIP_ANGLE] = out[OutColumn.SLIP_ANGLE]
    for k in range(3):
        report[ReportColumn.FORCE_X + k] = wrench[k]
    report[ReportColumn.TORQUE] = out[OutColumn.TORQUE]
    report[ReportColumn.SOIL] = soil_number
    report[ReportColumn.DEFLECTION] = out[OutColumn.DEFLECTION]
    report[ReportColumn.ROLLING_RESISTANCE] = out[OutColumn.ROLLING_RESISTANCE]
    report[ReportColumn.COMPACTION_RESISTANCE] = out[OutColumn.COMPACTION_RESISTANCE]
    report[ReportColumn.BULLDOZING_RESISTANCE] = out[OutColumn.BULLDOZING_RESISTANCE]
    report[ReportColumn.POWER] = out[OutColumn.POWER]
