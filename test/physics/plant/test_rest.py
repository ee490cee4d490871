"""Long steps of a plant at rest: what stepping comes to, an account that adds up, an end where there is news."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.plant.rest import (
    CHARGE_STEP,
    MOST_PARTS,
    REST_PERIODS,
    RESTLESS,
    Noticed,
    Rest,
    _parts_after,
    is_told_the_same,
    leap,
    rest_after,
)
from sojourn_physics.plant.state import PlantCommand, PlantState, zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant

MINUTE, SHORT = 3000, 1000
"""Control periods."""


class Rested(NamedTuple):
    """A machine that has come to rest."""

    model: Any
    state: PlantState
    rest: Rest
    command: PlantCommand


@pytest.fixture(scope="module")
def rested() -> Rested:
    """In the evening before a lunar night, told to hold what it has."""
    model, state = build_plant(load_scenario("lunar_night"))
    command, rest = zeros_command(len(model.joints.names), len(model.loads)), RESTLESS
    command.reference[0] = state.motor_angles
    while not rest.is_deep or state.tick % 50 != 49:
        assert state.tick < 1000
        state, output = step(model, state, command)
        rest = rest_after(model, rest, state, command, output)
    return Rested(model, state, rest, command)


def heat(state: PlantState) -> FloatArray:
    assert state.heat is not None
    return state.heat.nodes.thermal.temperatures


def test_a_third_of_a_minute_at_once_is_what_it_is_stepped(rested: Rested) -> None:
    model, begun, rest, command = rested
    stepped = begun
    for _ in range(SHORT):
        stepped, _ = step(model, stepped, command)
    leapt, output = leap(model, begun, rest, command, [SHORT])
    assert leapt.tick == stepped.tick
    np.testing.assert_allclose(leapt.configuration, stepped.configuration, atol=1e-5)
    spent = begun.power.stores[0].soc - stepped.power.stores[0].soc
    assert begun.power.stores[0].soc - leapt.power.stores[0].soc == pytest.approx(spent, rel=0.01)
    np.testing.assert_allclose(heat(leapt), heat(stepped), atol=0.02)
    assert leapt.power.stores[0].temperature == pytest.approx(stepped.power.stores[0].temperature, abs=0.01)
    for now, then, earlier in zip(leapt.power.energy, stepped.power.energy, begun.power.energy, strict=True):
        assert now - earlier == pytest.approx(then - earlier, rel=0.01, abs=1e-9)
    held = stepped.energy.electrical - begun.energy.electrical
    assert leapt.energy.electrical - begun.energy.electrical == pytest.approx(held, rel=0.01, abs=0.1)
    # what is told of it is its mean
    given = leapt.power.energy.loads - begun.power.energy.loads
    assert float(output.power.load_power.sum()) * 20.0 == pytest.approx(given, rel=1e-9)


def test_steps_of_any_length_lead_to_the_same(rested: Rested) -> None:
    """The evening's light and the cooling of the machine in steps of ten seconds and of a minute."""
    model, begun, rest, command = rested
    fine, _ = leap(model, begun, rest, command, [MINUTE // 10] * 20)
    coarse, output = leap(model, begun, rest, command, [MINUTE] * 2)
    assert fine.tick == coarse.tick
    spent = begun.power.stores[0].soc - fine.power.stores[0].soc
    assert begun.power.stores[0].soc - coarse.power.stores[0].soc == pytest.approx(spent, rel=0.01)
    np.testing.assert_allclose(heat(coarse), heat(fine), atol=0.05)
    assert coarse.power.stores[0].temperature == pytest.approx(fine.power.stores[0].temperature, abs=0.1)
    account = coarse.power.energy
    assert account.sources + account.stores == pytest.approx(account.loads + account.converters + account.shunts)
    assert sum(output.power.source_powers) * 120.0 == pytest.approx(account.sources - begun.power.energy.sources)


def test_a_leap_ends_where_the_charge_has_moved(rested: Rested) -> None:
    model, begun, rest, command = rested
    ended, _ = leap(model, begun, rest, command, [MINUTE] * 60)
    steps = (ended.tick - begun.tick) // MINUTE
    assert 2 < steps < 60
    before, _ = leap(model, begun, rest, command, [MINUTE] * (steps - 1))
    moved = [begun.power.stores[0].soc - state.power.stores[0].soc for state in (before, ended)]
    assert moved[0] <= CHARGE_STEP < moved[1]


SEEN = Noticed(np.array([0.5]), np.array([290.0]), 40.0, 80.0, (False,), True)


@pytest.mark.parametrize(
    ("change", "is_news"),
    [
        ({}, False),
        ({"charges": np.array([0.496])}, False),
        ({"charges": np.array([0.494])}, True),
        ({"temperatures": np.array([293.0])}, True),
        ({"given": 43.0}, False),
        ({"given": 35.0}, True),
        ({"short": (True,)}, True),
        ({"lit": False}, True),
    ],
)
def test_what_is_news(change: dict[str, Any], is_news: bool) -> None:
    assert SEEN.differs(SEEN._replace(**change)) == is_news


def test_what_wakes_a_machine(rested: Rested) -> None:
    model, state, rest, command = rested
    moved, column = command.reference.copy(), int(model.reference_rows(["wheel_front_left_joint"])[0])
    moved[1, column] = 0.2
    assert not is_told_the_same(model, command, replace(command, reference=moved))
    fed = command.reference.copy()
    fed[2] += 1e-3  # noise of what gravity is taken to be
    assert is_told_the_same(model, command, replace(command, reference=fed))
    fractions, names = command.load_fractions.copy(), [load.name for load in model.loads]
    fractions[names.index("cameras")] = 0.0
    assert is_told_the_same(model, command, replace(command, load_fractions=fractions))
    fractions[names.index("drive")] = 0.0
    assert not is_told_the_same(model, command, replace(command, load_fractions=fractions))
    dead = np.ones(len(model.joints.names))
    dead[column] = 0.0
    assert not is_told_the_same(model, command, replace(command, motor_health=dead))
    assert rest.output is not None
    pushed = replace(state, velocity=state.velocity + 1e-3)
    assert rest_after(model, rest, pushed, command, rest.output) is RESTLESS


def test_a_step_is_as_short_as_the_heat_asks_for() -> None:
    assert [_parts_after(4, heated) for heated in (0.2, 0.05, 0.01)] == [8, 4, 2]
    assert _parts_after(MOST_PARTS, 1.0) == MOST_PARTS and _parts_after(1, 0.0) == 1


def test_a_machine_that_does_not_rest_takes_no_leap(rested: Rested) -> None:
    model, state, rest, command = rested
    with pytest.raises(InvalidValueError, match=f"before a leap.*{REST_PERIODS} or more"):
        leap(model, state, rest._replace(periods=3), command, [MINUTE])
