"""What a run's flight side is made of: the machine as it is believed to be, and what its operators have told it.

By its type nothing of the plant's truth can be reached from here: no soil, terrain, wind, fault, no true power.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sojourn_config.known_machine import KnownMachine
from sojourn_flight.hazards.zone_params import KeepOutZone
from sojourn_flight.power_manager.activities import ActivityParams
from sojourn_physics.environment.sun.over import SunOver
from sojourn_physics.environment.sun.path import SunParams
from sojourn_physics.link.params import LinkParams
from sojourn_physics.plant.params import LeapParams
from sojourn_physics.terrain.height_field import HeightField

if TYPE_CHECKING:
    from sojourn_config.scenario import StartConfig


@dataclass(frozen=True, slots=True, eq=False)
class FlightScenario(KnownMachine):
    """A scenario as the roles that would fly know it.

    Args:
        start: where the machine is said to stand at the start.
        start_height: of base_link in map there, as it is said [m]; asks for the ground, which takes a while to make.
        sun: the date, or the Sun's place then: an ephemeris.
        activities: what is planned for the hours and days ahead.
        leaps: how the clock of the run leaps; None where it does not.
        keep_out: zones into which the drive must not go.
        link: to Earth, for the topics that it brings; None where there is none.
    """

    start: "StartConfig"
    start_height: Callable[[], float]
    sun: SunParams
    activities: tuple[ActivityParams, ...]
    leaps: LeapParams | None = None
    keep_out: tuple[KeepOutZone, ...] = ()
    link: LinkParams | None = None

    def sun_over(self, terrain: Callable[[], HeightField] | None = None) -> SunOver:
        """The Sun over the site, by the ephemeris. terrain: makes ground that may hide it, where any is known."""
        return SunOver(self.sun, self.body, self.site, terrain)
