"""Keep-out zones: what is in one, goals refused, ways led round, motions stopped; with nothing there to be seen."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from obstacle_examples import dense
from pydantic import ValidationError
from test_avoidance import AVOIDANCE, DRIVE, TURNING, at

from sojourn_flight.hazards.keep_out import NO_ZONES, KeepOut
from sojourn_flight.hazards.zone_params import KeepOutZone, first_in
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.follower_state import FollowerState
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.planning.goal_follower import accept
from sojourn_flight.supervision.avoidance import accepted, guarded, guide, initial_avoidance, see
from sojourn_flight.supervision.avoidance_types import Avoidance, AvoidanceState
from sojourn_flight.supervision.path_check import closed_ahead
from sojourn_flight.supervision.zone_check import clear_of_zones

LEVEL = dense(lambda x, y: 0.0 * x)


def box(x0: float, x1: float, y0: float, y1: float, name: str = "lander") -> KeepOut:
    return KeepOut((KeepOutZone(name=name, points=((x0, y0), (x1, y0), (x1, y1), (x0, y1))),))


def known_with(zones: KeepOut) -> tuple[Avoidance, AvoidanceState]:
    """Level ground that has been seen ahead."""
    avoidance = replace(AVOIDANCE, keep_out=zones)
    return avoidance, see(avoidance, initial_avoidance(avoidance, 0.0, 0.0), LEVEL, at(0.0, 0.0), 0.02)


def answer_to(goal: Goal, zones: KeepOut, seen: bool = True) -> FollowerState | GoalOutcome:
    here = at(0.0, 0.0)
    answer = accept(DRIVE.follower, TURNING, goal, Pose(0.0, 0.0, 0.0))
    avoidance, state = known_with(zones)
    return clear_of_zones(zones, avoidance if seen else None, state if seen else None, goal, answer, here)


def nearest(answer: FollowerState, zones: KeepOut) -> float:
    places = np.concatenate([leg.samples[:, 1:3] for leg in answer.path.legs])
    return float(min(zone.distances(places).min() for zone in zones.zones))


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-math.pi, math.pi))
def test_distances_are_those_of_a_turned_square(x: float, y: float, turn: float) -> None:
    corners = np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
    rotation = np.array([(math.cos(turn), -math.sin(turn)), (math.sin(turn), math.cos(turn))])
    zone = KeepOutZone(name="square", points=tuple(map(tuple, (corners @ rotation.T).tolist())))
    outside = np.maximum(np.abs(np.array([x, y]) @ rotation) - 1.0, 0.0)
    assert zone.distances(np.array([[x, y]]))[0] == pytest.approx(float(np.hypot(*outside)), abs=1e-9)


def test_a_bay_of_a_zone_is_outside() -> None:
    horseshoe = ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (3.0, 3.0), (3.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0))
    zone = KeepOutZone(name="u", points=horseshoe)
    assert zone.distances(np.array([(2.0, 2.0), (0.5, 2.0), (2.0, 0.5)])).tolist() == [1.0, 0.0, 0.0]
    assert first_in([zone], np.array([(2.0, 2.0), (0.5, 2.0)])) == (1, zone)
    assert first_in([zone], np.array([(2.0, 2.0)])) is None


def test_what_encloses_nothing_is_no_zone() -> None:
    for points in (
        ((0.0, 0.0), (1.0, 0.0)),
        ((0.0, 0.0), (1.0, 1.0), (2.0, 2.0)),
        ((0.0, 0.0), (1.0, 0.0), (0.0, 1e9)),
    ):
        with pytest.raises(ValidationError):
            KeepOutZone(name="line", points=points)
    with pytest.raises(ValidationError, match="polygon with an area"):
        KeepOutZone(name="line", points=((0.0, 0.0), (1.0, 1.0), (2.0, 2.0)))


def test_a_goal_in_a_zone_is_refused_by_its_name() -> None:
    for goal, words in (
        (Goal.at(20.0, 0.0), "lies in the keep-out zone lander"),  # far beyond all maps
        (Goal.at(18.7, 0.0), "lies too near to the keep-out zone lander"),
        (Goal.along([(19.5, 0.0), (30.0, 0.0)]), r"\(19.50, 0.00\) lies in"),
    ):
        for seen in (True, False):
            answer = answer_to(goal, box(19.0, 21.0, -1.0, 1.0), seen)
            if seen or "near" not in words:
                assert isinstance(answer, GoalOutcome) and answer.kind == "refused"
                assert re.search(words, answer.reason)


@pytest.mark.parametrize(("x0", "reach"), [(3.0, 8.0), (9.0, 14.0)])
def test_a_way_through_a_zone_is_led_round_it_at_once(x0: float, reach: float) -> None:
    """Near, on the map, and far, where only the wide map has it; the zone reaches further to the right."""
    zones, goal = box(x0, x0 + 1.5, -3.0, 1.0), Goal.at(reach, 0.0)
    free = answer_to(goal, NO_ZONES)
    answer = answer_to(goal, zones)
    assert isinstance(answer, FollowerState) and isinstance(free, FollowerState)
    assert nearest(free, zones) == 0.0
    assert nearest(answer, zones) >= AVOIDANCE.params.outline.half_width
    samples = np.concatenate([leg.samples for leg in answer.path.legs])
    assert samples[:, 2].max() > 1.0, "by the shorter side"
    assert (samples[-1, 1], samples[-1, 2]) == pytest.approx((reach, 0.0), abs=0.01)
    assert answer.goal == goal


def test_where_no_way_is_known_or_none_can_be_planned_it_is_refused() -> None:
    ring = [box(-6, 6, 5, 6, "n"), box(-6, 6, -6, -5, "s"), box(5, 6, -6, 6, "e"), box(-6, -5, -6, 6, "w")]
    closed = KeepOut(tuple(zone for one in ring for zone in one.zones))
    answer = answer_to(Goal.at(12.0, 0.0), closed)
    assert isinstance(answer, GoalOutcome)
    assert "through the keep-out zone e at (4" in answer.reason and "know no way round" in answer.reason
    answer = answer_to(Goal.at(8.0, 0.0), box(3.0, 4.0, -1.0, 1.0), seen=False)
    assert isinstance(answer, GoalOutcome) and "without obstacle handling" in answer.reason


def test_no_motion_leads_into_a_zone_and_what_stops_it_has_its_name() -> None:
    avoidance, state = known_with(box(1.2, 3.0, -1.0, 1.0))
    ahead, behind = PlanarTwist(0.1, 0.0, 0.0), PlanarTwist(-0.1, 0.0, 0.0)
    stops = [x for x in np.arange(0.0, 0.6, 0.05).tolist() if not guarded(avoidance, state, ahead, at(x, 0.0), True)[1]]
    assert stops and stops[0] + avoidance.params.outline.front < 1.2
    held, _ = guarded(avoidance, state, ahead, at(stops[0], 0.0), True)
    assert str(held.obstacle).startswith("keep-out zone lander at (1.")
    assert guarded(avoidance, state, behind, at(stops[0], 0.0), True)[1]
    assert guarded(AVOIDANCE, known_with(NO_ZONES)[1], ahead, at(stops[0], 0.0), True)[1]


def test_a_way_that_obstacles_lead_into_a_zone_is_planned_again() -> None:
    """A block ahead; round it by the left would be shorter, but there is a zone."""
    block = dense(lambda x, y: np.where((x > 2.0) & (x < 2.4) & (abs(y - 0.3) < 1.0), 0.3, 0.0))
    sides = {}
    for name, zones in (("free", NO_ZONES), ("zone", box(1.0, 4.0, -6.0, -0.7))):
        avoidance = replace(AVOIDANCE, keep_out=zones)
        state = see(avoidance, initial_avoidance(avoidance, 0.0, 0.0), block, at(0.0, 0.0), 0.02)
        goal = Goal.at(6.0, 0.0)
        answer = accept(DRIVE.follower, TURNING, goal, Pose(0.0, 0.0, 0.0))
        answer, state = accepted(avoidance, state, goal, answer, at(0.0, 0.0))
        assert isinstance(answer, FollowerState)
        step = guide(avoidance, state, answer, at(0.0, 0.0))
        assert step.outcome is None and step.state.detours == 1
        assert closed_ahead(avoidance, step.state, step.way, 0.0) is None
        samples = np.concatenate([leg.samples for leg in step.way.path.legs])
        sides[name] = samples[np.abs(samples[:, 2]).argmax(), 2]
    assert sides["free"] < 0.0 < sides["zone"]
