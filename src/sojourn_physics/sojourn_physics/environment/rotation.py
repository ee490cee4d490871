"""How a body turns against the stars, about the z axis of its own frame."""

import math

from pydantic import Field, field_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params


class RotationParams(Params):
    """Rotation of a body. A moon that shows its planet one face turns once a month."""

    sidereal_hours: float = Field(description="one turn against the stars; westward, as of Venus, negative [h]")
    locked: bool | None = Field(
        default=None, description="a moon's: its meridian of longitude 0 stays under its planet; none: it does not"
    )

    @field_validator("sidereal_hours")
    @classmethod
    def _turns(cls, hours: float) -> float:
        if hours == 0.0:
            raise InvalidValueError("sidereal_hours", hours, "not 0: leave out the table of a body that does not turn")
        return hours

    @property
    def rate(self) -> float:
        """Eastward [rad/s]."""
        return 2.0 * math.pi / (3600.0 * self.sidereal_hours)

    @property
    def tide(self) -> float:
        """Of what a locked moon goes about: GM/a^3, on a circle the square of the rate [1/s^2]."""
        return self.rate**2 if self.locked else 0.0
