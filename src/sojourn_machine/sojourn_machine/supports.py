"""What meets the ground: wheels, tracks, feet of legs, and pads on bodies."""

from pydantic import Field

from sojourn_machine.contact_choice import DEFAULT_CONTACT, DEFAULT_FOOT_CONTACT, Contact, FootContact
from sojourn_machine.params import Params


class SupportParams(Params):
    """One thing that meets the ground."""

    name: str = Field(min_length=1, description="its name")


class WheelParams(SupportParams):
    """One wheel."""

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


class TrackEndParams(Params):
    """How a track rises at one of its ends: straight up an incline, then about the wheel at its end."""

    angle_deg: float = Field(ge=5.0, le=85.0, description="of the incline [degree]")
    length: float = Field(ge=0.0, le=5.0, description="of the incline [m]")
    radius: float = Field(gt=0.0, le=2.0, description="of the wheel about which the track turns up [m]")


class TrackParams(SupportParams):
    """One track on a body of the machine."""

    joint: str = Field(min_length=1, description="joint of the sprocket, about its axle; forwards is positive")
    link: str = Field(min_length=1, description="link of the URDF that carries it; its x axis is ahead, z is up")
    position: tuple[float, float, float] = Field(
        description="middle of the flat run, on the outside of the links, in the link's frame, shape (3,) [m]"
    )
    radius: float = Field(gt=0.0, le=2.0, description="of the sprocket, to the outside of the links [m]")
    length: float = Field(gt=0.0, le=10.0, description="of the flat run [m]")
    width: float = Field(gt=0.0, le=3.0, description="[m]")
    front: TrackEndParams
    rear: TrackEndParams
    road_wheels: int = Field(default=1, ge=1, le=8, description="number of road wheels on the flat run [-]")
    peakedness: float = Field(
        default=0.0, ge=0.0, lt=1.0, description="a: the pressure along the flat run is between 1 - a and 1 + a [-]"
    )
    plates: int = Field(default=12, ge=2, le=200, description="in which the flat run meets the ground [-]")

    @property
    def shear_radius(self) -> float:
        """Radius on which the soil shears [m]: the outside of the links."""
        return self.radius

    @property
    def steer_joint(self) -> str | None:
        """What turns it: nothing does."""
        return None


class FootParams(SupportParams):
    """The foot of a leg: a flat round pad."""

    link: str = Field(min_length=1, description="link of the URDF that carries it; it stands on the link's z axis")
    position: tuple[float, float, float] = Field(description="middle of its sole in the link's frame, shape (3,) [m]")
    radius: float = Field(gt=0.0, le=2.0, description="of its sole [m]")
    contact: FootContact = Field(default=DEFAULT_FOOT_CONTACT, description="contact model and its own parameters")


class ScoopParams(Params):
    """A tool whose end is a pad, and whose flank cuts the soil like a blade: see `sojourn_physics.soil.digging`."""

    width: float = Field(gt=0.0, le=2.0, description="of the cut [m]")
    rake_deg: float = Field(default=90.0, ge=20.0, le=120.0, description="rake angle of the flank [degree]")
    tool_friction_deg: float = Field(default=15.0, ge=0.0, le=45.0, description="of soil on the tool [degree]")


class PadParams(SupportParams):
    """A round pad on a body: where the chassis, the mast or the arm's tip would touch the ground."""

    link: str = Field(min_length=1, description="link of the URDF that carries it")
    position: tuple[float, float, float] = Field(description="centre of the pad in the link's frame, shape (3,) [m]")
    radius: float = Field(gt=0.0, le=2.0, description="radius of the pad [m]")
    scoop: ScoopParams | None = Field(default=None, description="what it cuts the soil with when dragged, or nothing")
    is_tool: bool = Field(
        default=False, description="whether it is the end of the arm's tool: it meets what has been dug"
    )
