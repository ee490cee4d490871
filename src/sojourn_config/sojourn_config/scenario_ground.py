"""The ground of a scenario, and how high a machine stands on it."""

from pathlib import Path
from typing import TYPE_CHECKING

from sojourn_config.errors import single
from sojourn_config.yaml_file import YamlDocument
from sojourn_flight.mobility.ability import Ability
from sojourn_machine.errors import MachineError
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.params import TerrainParams

if TYPE_CHECKING:
    from sojourn_config.scenario import ScenarioConfig, StartConfig
    from sojourn_physics.terrain.raster import Raster

# What makes and reads ground is loaded where it is needed: it loads scipy, and GDAL, which most nodes do not need, and
# each of them starts so much sooner.


def read_raster(terrain: TerrainParams, document: YamlDocument, folder: Path) -> "tuple[Raster | None, dict[str, str]]":
    """What the file of a terrain holds, None where it has none; and the digests of what was read, by name.

    Args:
        document: the scenario, for messages. folder: its folder.

    Raises:
        ConfigError: a file that cannot be used.
    """
    if terrain.file is None:
        return None, {}
    from sojourn_config.raster_file import RasterReader
    from sojourn_config.recorded_raster import recorded_raster

    rasters = RasterReader(document, folder, terrain, terrain.file)
    return recorded_raster() or rasters.read(), rasters.digests


def made_ground(config: "ScenarioConfig", soils: tuple[str, str], raster: "Raster | None", file: str) -> HeightField:
    """The ground, from the scenario's seed.

    Args:
        soils: names of the default soil and of that of rocks. file: the scenario's, for messages.

    Raises:
        ConfigError: it cannot be made with these parameters.
    """
    from sojourn_physics.terrain.generate import generate

    try:
        return generate(config.terrain, *soils, config.seed, raster)
    except MachineError as error:
        raise single(file, "terrain", config.terrain.kind, str(error)) from error


def base_height(ground: HeightField, ability: Ability, start: "StartConfig") -> float:
    """Of base_link in map at a start, on ground that does not give way [m]. ability: of what moves the machine."""
    from sojourn_physics.terrain.standing_ground import StandingGround

    standing = StandingGround(ground, ability.supports, ability.ride_height)
    return float(standing.pose(start.x, start.y, start.yaw)[0][2])
