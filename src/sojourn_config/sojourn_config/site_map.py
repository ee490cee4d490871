"""The map of a scenario's site on which operators plan: from orbit, with what they believe of the machine."""

from sojourn_config.scenario import LoadedScenario
from sojourn_flight.planning.global_route import SiteMap
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.terrain.height_field import HeightField


def site_map(loaded: LoadedScenario, ground: HeightField | None = None) -> SiteMap:
    """Of a scenario. ground: of it, where it has been made.

    Raises:
        InvalidValueError: for a machine whose slopes are not known: it handles no obstacles.
        ConfigError: the ground cannot be made.
    """
    from sojourn_physics.terrain.orbital import orbital_map  # here: it loads scipy

    obstacles = loaded.as_believed().drive.obstacles
    if obstacles is None:
        allowed = "a table: a route over the map needs the slopes that the machine drives"
        raise InvalidValueError("flight.drive.obstacles", None, allowed)
    seen = orbital_map(ground or loaded.height_field(), loaded.config.orbital_map, loaded.config.seed)
    keep = obstacles.outline.turn_radius + obstacles.margin
    return SiteMap(*seen, obstacles.passable.tilts, keep, loaded.config.keep_out)
