"""What is round a machine to heat, where it stands at the start: ground, sky, light, air."""

from sojourn_config.expected_light import LightAtStart, Sited, light_at_start
from sojourn_flight.power_manager.preview import Warmth
from sojourn_machine.thermal.machine_heat import MachineHeat
from sojourn_physics.thermal.site_heat import SiteHeat


def site_heat(scenario: Sited, light: LightAtStart | None = None) -> SiteHeat | None:
    """Of the site of a scenario; None for a machine whose heat its files do not say.

    Args:
        light: where the machine starts; left out: with the far horizon alone.

    Raises:
        InvalidValueError: as `SiteGround` does.
    """
    if scenario.thermal is None:
        return None
    return SiteHeat(scenario.thermal, scenario.body, scenario.site, light or light_at_start(scenario))


def heat_at_start(scenario: Sited, light: LightAtStart | None = None) -> Warmth | None:
    """The heat of a machine that stays at its start; see `site_heat`."""
    light = light or light_at_start(scenario)
    site = site_heat(scenario, light)
    if site is None:
        return None
    return Warmth(MachineHeat(site.params, scenario.power), lambda time: site.around(time, light(time)))
