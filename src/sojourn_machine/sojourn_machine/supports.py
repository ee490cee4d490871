"""What touches the ground: wheels, and pads on bodies."""

from pydantic import Field

from sojourn_machine.contact_choice import DEFAULT_CONTACT, Contact
from sojourn_machine.params import Params


class WheelParams(Params):
    """One wheel."""

    name: str = Field(min_length=1, description="name of the wheel")
    joint: str = Field(min_length=1, description="drive joint, about the wheel's axle")
    steer_joint: str | None = Field(default=None, description="steering joint, or none")
    radius: float = Field(gt=0.0, le=5.0, description="radius of the rim, without grousers [m]")
    width: float = Field(gt=0.0, le=3.0, description="width of the rim [m]")
    grouser_height: float = Field(default=0.0, ge=0.0, le=0.2, description="height of the grousers [m]")
    grouser_count: int = Field(default=0, ge=0, le=500, description="number of grousers on the rim [-]")
    contact: Contact = Field(default=DEFAULT_CONTACT, description="contact model and its own parameters")

    @property
    def shear_radius(self) -> float:
        """Radius of the circle on which the soil shears [m]: the tips of the grousers, if there are any."""
        return self.radius + (self.grouser_height if self.grouser_count else 0.0)


class ScoopParams(Params):
    """A tool whose end is a pad, and whose flank cuts the soil like a blade: see `sojourn_physics.soil.digging`."""

    width: float = Field(gt=0.0, le=2.0, description="of the cut [m]")
    rake_deg: float = Field(default=90.0, ge=20.0, le=120.0, description="rake angle of the flank [degree]")
    tool_friction_deg: float = Field(default=15.0, ge=0.0, le=45.0, description="of soil on the tool [degree]")


class PadParams(Params):
    """A round pad on a body: where the chassis, the mast or the arm's tip would touch the ground."""

    name: str = Field(min_length=1, description="name of the pad")
    link: str = Field(min_length=1, description="link of the URDF that carries it")
    position: tuple[float, float, float] = Field(description="centre of the pad in the link's frame, shape (3,) [m]")
    radius: float = Field(gt=0.0, le=2.0, description="radius of the pad [m]")
    scoop: ScoopParams | None = Field(default=None, description="what it cuts the soil with when dragged, or nothing")
    is_tool: bool = Field(
        default=False, description="whether it is the end of the arm's tool: it meets what has been dug"
    )
