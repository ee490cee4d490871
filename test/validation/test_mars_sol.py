"""A sol on Mars by the array of a Mars Exploration Rover: sunlight through dust, cells in the cold, energy of the day.

About 900 Wh a sol with clean cells is published (Crisp et al. 2003, J. Geophys. Res. 108(E12):8061). The regulator of
the file is fitted to it; how the energy falls with dust in the air, and how cold the cells are, is not.
"""

import numpy as np
import pytest

from sojourn_config.load import load_params
from sojourn_machine.power.photovoltaic_array import PhotovoltaicArrayParams
from sojourn_machine.power.surroundings import UPRIGHT, PowerSurroundings
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteParams
from sojourn_physics.environment.sun.over import SunOver
from sojourn_physics.environment.sun.path import SunParams

SOL, STEP = 88775.244, 300.0
MERIDIANI = SiteParams(latitude_deg=-1.95, longitude_deg=354.47)
ARRAY = load_params("parts", "mer_array", PhotovoltaicArrayParams)


def sol(optical_depth: float) -> tuple[float, float, float]:
    """Energy [Wh], sunlight on the level [Wh/m2], and the hottest the cells get [K]."""
    date = SunParams.model_validate({"time": "2004-01-25T05:05:00Z", "optical_depth": optical_depth})
    sun = SunOver(date, load_params("bodies", "mars", BodyParams), MERIDIANI)
    state, energy, light, hottest = ARRAY.initial_state(), 0.0, 0.0, 0.0
    for time in np.arange(0.0, SOL, STEP):
        now = sun.light(float(time), 0.0, 0.0)
        around = PowerSurroundings(now.direction, now.direct, now.diffuse, UPRIGHT, 200.0)
        power = ARRAY.point(state, around).power
        state = ARRAY.step(state, power, STEP, around)
        energy += power * STEP / 3600.0
        light += (now.direct * max(float(now.direction[2]), 0.0) + now.diffuse) * STEP / 3600.0
        hottest = max(hottest, state.temperature)
    return energy, light, hottest


@pytest.mark.published("Crisp et al. 2003, J. Geophys. Res. 108(E12):8061")
def test_a_clean_sol() -> None:
    energy, light, hottest = sol(0.5)
    assert energy == pytest.approx(900.0, rel=0.05)
    assert 3500.0 < light < 4300.0, (
        "Appelbaum & Flood 1990: 3.5 to 4.2 kWh/m2 near the equator at an optical depth of 0.5"
    )
    assert 260.0 < hottest < 290.0


def test_dust_in_the_air_leaves_less_and_a_storm_a_tenth() -> None:
    energies = [sol(depth)[0] for depth in (0.3, 1.0, 3.0, 5.0, 10.8)]
    assert energies == sorted(energies, reverse=True)
    assert energies[-1] < 0.12 * energies[0], (
        "Opportunity had 22 Wh a sol on 10 June 2018, with dust on its cells besides"
    )
