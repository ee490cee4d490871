"""Charge that the lunar roving vehicle takes in the plant, beside what its traverses on the Moon took.

27.76, 26.55 and 35.89 km on Apollo 15, 16 and 17 with 1.87, 2.11 and 1.64 Ah/km (without what else was fed from its
batteries): 52, 56 and 59 Ah of 242. In the plant it drives straight on level ground; grades, craters, curves, starts
and halts of the real ones are left out, and its silver-zinc batteries are on their upper plateau.
"""

import numpy as np
import pytest

from sojourn_flight.planning.goal import Goal
from sojourn_studies.measure_energy import MeteredLoop, ends_of_way
from sojourn_studies.measure_slip import on_plane

TRAVERSES = {"Apollo 15": (27.76, 1.87), "Apollo 16": (26.55, 2.11), "Apollo 17": (35.89, 1.64)}
"""[km], [Ah/km]"""


def charge_per_km() -> float:
    """At full speed on nominal lunar soil [Ah/km]."""
    loop = MeteredLoop(on_plane("flat_drive", ["machine=lrv"], 0.0, 0.0))
    first, last = ends_of_way(loop.scenario.drive)
    loop.tick(Goal.at(first + 5.0 + last, 0.0))
    drawn: list[float] = []
    places: list[float] = []
    while loop.to_go() > last:
        loop.tick()
        if loop.to_go() < 5.0 + last and loop.plant_output is not None:
            drawn.append(sum(loop.plant_output.power.store_currents))
            places.append(float(loop.truth.configuration[0]))
    seconds = len(drawn) * loop.plant.simulation.control_period
    return float(np.mean(drawn)) * seconds / 3600.0 / (1e-3 * (places[-1] - places[0]))


@pytest.mark.published("51.9, 56.0 and 58.9 Ah on Apollo 15, 16 and 17")
def test_charge_of_three_traverses() -> None:
    each = charge_per_km()
    for name, (distance, published) in TRAVERSES.items():
        assert each * distance == pytest.approx(published * distance, rel=0.25), name
    mean = np.mean([published for _, published in TRAVERSES.values()])
    assert each == pytest.approx(mean, rel=0.15)
