"""A rover drives out of the shadow that a boulder throws: its Sun sensor and its camera, which has no lamp, see nothing
in it and something out of it, and from there on the heading is fixed by the Sun."""

from typing import Any

import numpy as np

from sojourn_config.scenario import load_scenario
from sojourn_physics.plant.light import sunlight_on
from sojourn_stack.apps import make_apps
from sojourn_stack.stack import Stack

ROLES = ("plant", "sensors", "drive", "power", "operator")
MIDDLE, HALF = -1.0, 1.25
"""Of the boulder in x, and so of its shadow."""
OVERRIDES = [
    "terrain={kind: generated, size_x: 20.0, size_y: 20.0, resolution: 0.1, "
    f"rocks: [{{x: {MIDDLE}, y: 3.5, diameter: {2.0 * HALF}, height: 3.0}}]}}",
    "start.x=-0.6",
    "sun={azimuth_deg: 0.0, elevation_deg: 20.0, ground_hides: true}",
    "sensors.hazcam.least_light=1.0",
    "blind_drive=true",  # else it waits in the dark for a camera that sees
    "steps=[{drive_to: {x: 1.2, y: 0.0}, timeout_s: 100.0}]",
]


def test_out_of_a_boulders_shadow_it_sees_again() -> None:
    stack = Stack(make_apps(load_scenario("flat_drive", OVERRIDES), ROLES), ROLES)
    state, _ = stack.begin()
    model = stack.apps["plant"].model  # type: ignore[attr-defined]
    places, seen, lit, points, fixes = [], [], [], [], []
    while not places or places[-1] < 1.0:
        assert state.period < 60 * 50, "it does not get there"
        state, said = stack.step(state)
        now: dict[str, Any] = {row.name: message for row, message in said}
        if "/sun_direction" in now:
            machine = state.roles["plant"].app.machine
            places.append(float(machine.configuration[0]))
            lit.append(sunlight_on(model, machine).direct)
            seen.append(bool(np.any(now["/sun_direction"].vector)))
            points.append(now["/hazcam/points"].width)
            fixes.append(state.roles["drive"].app.drive.heading.fixes)
    out = seen.index(True)
    assert out > 2 and all(seen[out:])
    assert [width > 100 for width in points] == seen
    assert [light > 1000.0 for light in lit] == seen and not any(lit[:out])
    assert fixes[out - 1] == 0 and fixes[-1] >= len(seen) - out - 1
    # half the boulder from its middle, a square of half a metre, and the way of a second
    assert MIDDLE + 0.5 * HALF < places[out] < MIDDLE + HALF + 0.5 + 0.15
