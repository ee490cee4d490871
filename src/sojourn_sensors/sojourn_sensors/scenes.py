"""The scene that the cameras of a run see: its ground, and the light of a moment."""

from sojourn_config.scenario import LoadedScenario
from sojourn_contract import stamps
from sojourn_machine.params import FloatArray
from sojourn_machine.shapes import Shapes
from sojourn_physics.imaging.photometry import Illumination
from sojourn_physics.imaging.scenery import GroundLook, Moment, Scenery, sun_of
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import GroundMemory

ROCK = 1.25
"""Brightness of rocks, of the soil's: an estimate, for rocks without dust are seen to be brighter."""
SUN_EVERY = 60.0
"""The Sun stands still for a camera this long [s]: by half of its disc on Mars or Earth."""


class CameraScene:
    """What the cameras of a run see.

    Args:
        scenario: of the run. ground: as it was at the start.
    """

    def __init__(self, scenario: LoadedScenario, ground: HeightField) -> None:
        self.scenery = Scenery(ground, look_of(scenario, ground.soil_names))
        self._sun = scenario.sun_over()  # what the ground hides the shadows know

    def moment(self, stamp: int, place: FloatArray, ground: GroundMemory, body: Shapes) -> Moment:
        """The scene at a stamp [ns].

        Args:
            place: of the camera in map, (3,) [m]. ground: what has been done to it. body: the machine's shapes.
        """
        time = stamps.seconds(stamp) // SUN_EVERY * SUN_EVERY
        light = self._sun.light(time, float(place[0]), float(place[1]))
        sun = sun_of(light.direction, self._sun.disc(time))
        return Moment(sun, Illumination(light.direct, light.diffuse), ground, body)


def look_of(scenario: LoadedScenario, soils: tuple[str, ...]) -> GroundLook:
    """How the ground of a scenario looks, which has these soils."""
    body = scenario.body
    albedo = scenario.config.sun.albedo if body.regolith is None else body.regolith.albedo_normal
    rock = scenario.rock_soil.name
    brightness = tuple(ROCK if name == rock and name != scenario.soil.name else 1.0 for name in soils)
    return GroundLook(albedo, body.surface_pressure == 0.0, body.radius, brightness)
