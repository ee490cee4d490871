"""Parameters of the slip estimate: what the drive believes of the soil, and how far it trusts motors and IMU."""

from pydantic import Field

from sojourn_machine.params import Params


class TractionCurve(Params):
    """Torque over load and radius as a function of the slip s: limit (1 - exp(-(s + offset) / softness))."""

    limit: float = Field(..., gt=0.0, le=5.0, description="what no slip exceeds [-]")
    softness: float = Field(..., gt=0.0, le=5.0, description="slip at which 63 % of the limit is reached [-]")
    offset: float = Field(..., ge=-0.5, le=1.0, description="slip that the rolling resistance takes the place of [-]")


class SlipParams(Params):
    """Sigmas are standard deviations."""

    fresh: TractionCurve = Field(..., description="of a wheel on ground that no other has pressed before it")
    rut: TractionCurve = Field(..., description="of a wheel in the rut of another")
    free_slip: float = Field(..., ge=-0.5, lt=1.0, description="slip of a wheel that neither pulls nor brakes [-]")
    rut_width: float = Field(..., gt=0.0, le=3.0, description="tracks nearer than this are one rut [m]")
    rotor_inertia: float = Field(..., ge=0.0, le=1e4, description="of a drive motor, at the wheel [kg m^2]")
    torque_lag: float = Field(..., gt=0.0, le=10.0, description="time over which torques are averaged [s]")
    torque_error: float = Field(
        ..., gt=0.0, le=1.0, description="error of the torques and of the curves, over the load times the radius [-]"
    )
    factor_sigma: float = Field(..., gt=0.0, le=2.0, description="slip over the believed one varies so much [-]")
    factor_length: float = Field(..., gt=0.0, le=1e9, description="distance after which the soil is another [m]")
    slip_noise: float = Field(..., gt=0.0, le=1.0, description="error of the believed slip that comes and goes [-]")
    slip_noise_time: float = Field(..., gt=0.0, le=100.0, description="in this time [s]")
    force_noise: float = Field(..., gt=0.0, le=1.0, description="velocity random walk of the IMU [m/s/s^0.5]")
    drift_sigma: float = Field(..., gt=0.0, le=1.0, description="levelling against the accelerometer at first [m/s^2]")
    accelerometer_bias: float = Field(
        ..., gt=0.0, le=1.0, description="after a turn it does not cancel with that of the levelling [m/s^2]"
    )
    accelerometer_flicker: float = Field(
        default=0.0, ge=0.0, le=1.0, description="coefficient B of the flicker of the accelerometer's bias [m/s^2]"
    )
    drift_walk: float = Field(..., gt=0.0, le=1.0, description="random walk of the acceleration's error [m/s^2/s^0.5]")
    least_speed: float = Field(..., gt=0.0, le=1.0, description="speed of the wheels below which no slip is told [m/s]")
    stuck_slip: float = Field(..., gt=0.0, lt=1.0, description="slip beyond which the machine makes no headway [-]")
    stuck_time: float = Field(..., gt=0.0, le=60.0, description="after this time it is told [s]")
    idle_torque: float = Field(
        ..., gt=0.0, lt=1.0, description="part of its expected torque below which a wheel has no load [-]"
    )
    idle_time: float = Field(..., gt=0.0, le=60.0, description="after this time that is told [s]")
