"""The contact law of a wheel, by the number in its row."""

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.bekker_wheel import bekker_wheel
from sojourn_physics.contact.brush import brush
from sojourn_physics.contact.compliant_wheel_on_soil import compliant_wheel_on_soil
from sojourn_physics.contact.contact_law import ContactModel, WheelColumn
from sojourn_physics.contact.firm_wheel_laws import coulomb_wheel
from sojourn_physics.contact.foot_pad import foot_pad
from sojourn_physics.contact.magic_formula import magic_formula
from sojourn_physics.contact.rigid_wheel_on_soil import rigid_wheel_on_soil
from sojourn_physics.contact.roller_wheel import roller_wheel
from sojourn_physics.contact.track import track


@kernel
def apply_law(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The law that the wheel's row names; arguments as in `contact_law`."""
    model = int(wheel[WheelColumn.MODEL])
    if model == ContactModel.RIGID_WHEEL_ON_SOIL:
        rigid_wheel_on_soil(wheel, soil, motion, dt, state, out)
    elif model == ContactModel.COMPLIANT_WHEEL_ON_SOIL:
        compliant_wheel_on_soil(wheel, soil, motion, dt, state, out)
    elif model == ContactModel.BEKKER_WHEEL_ON_SOIL:
        bekker_wheel(wheel, soil, motion, dt, state, out)
    elif model == ContactModel.BRUSH:
        brush(wheel, soil, motion, dt, state, out)
    elif model == ContactModel.MAGIC_FORMULA:
        magic_formula(wheel, soil, motion, dt, state, out)
    elif model == ContactModel.ROLLER_WHEEL:
        roller_wheel(wheel, soil, motion, dt, state, out)
    elif model == ContactModel.TRACK:
        track(wheel, soil, motion, dt, state, out)
    elif model == ContactModel.FOOT_PAD:
        foot_pad(wheel, soil, motion, dt, state, out)
    else:  # rigid ground, rigid or compliant wheel: their rows differ in what gives way
        coulomb_wheel(wheel, soil, motion, dt, state, out)
