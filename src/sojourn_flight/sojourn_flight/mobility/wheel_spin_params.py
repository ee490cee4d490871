"""Parameters of wheel spin, see `wheel_spin`."""

from pydantic import Field

from sojourn_machine.params import Params


class WheelSpinParams(Params):
    """When the accelerometer is believed rather than the wheels."""

    gate: float = Field(gt=0.0, le=10.0, description="difference of speeds from which the wheels spin [m/s]")
    settling: float = Field(gt=0.0, le=60.0, description="time in which the speed follows the wheels [s]")
    longest: float = Field(gt=0.0, le=60.0, description="time for which the accelerometer is good [s]")
