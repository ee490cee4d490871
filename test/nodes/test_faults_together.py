"""Faults of the plant that come one after another: those that it cannot have together are refused when they come."""

from functools import cache
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_contract.app import Period
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.fault_messages import FaultEvent, fault_message
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import topic
from sojourn_machine.fault_choice import read_fault_words
from sojourn_plant.app import PlantApp, PlantAppState

WHEEL, STEERING = "wheel_front_left_joint", "steer_front_left_joint"
WORDS: tuple[dict[str, Any], ...] = (
    {"kind": "string_lost"},
    {"kind": "cell_shorted", "cells": 5},
    {"kind": "bus_short", "resistance": 30.0},
    {"kind": "panel_stuck", "source": "array", "normal": [0.0, 1.0, 0.0]},
    {"kind": "array_dust", "source": "array", "share": 0.9},
    {"kind": "switch_stuck", "load": "cameras", "where": "on"},
    {"kind": "load_dead", "load": "cameras"},
    {"kind": "soft_patch", "x": 0.0, "y": 0.0, "radius": 2.0, "part": 0.5},
    {"kind": "soft_patch", "x": 0.0, "y": 0.0, "radius": 1.0, "part": 0.1},
    {"kind": "motor_dead", "joint": WHEEL},
    {"kind": "motor_weak", "joint": WHEEL, "part": 0.3},
    {"kind": "joint_seized", "joint": WHEEL},
    {"kind": "joint_free", "joint": WHEEL},
    {"kind": "gear_broken", "joint": WHEEL},
    {"kind": "servo_locked", "joint": STEERING},
    {"kind": "sensor", "sensor": "imu", "stuck": True},
)
LIMITED = ("string_lost", "cell_shorted")
"""Two of them are one too many for the battery of two strings of eight cells."""


@cache
def plant() -> PlantApp:
    return PlantApp(load_scenario("flat_drive", ["machine=explorer_solar"]))


def told(state: PlantAppState, period: int, *events: FaultEvent) -> tuple[PlantAppState, list[str]]:
    """The state after a period in which so much is said, and what was refused of it."""
    messages = [(FAULTS_TOPIC, fault_message(0, event)) for event in events]
    for name, message in messages:
        plant().check(topic(name), message)
    state, answer = plant().step(state, Period(period * CONTROL_PERIOD_NS, {}, messages))
    assert all(name == FAULTS_TOPIC for name, _ in answer.refusals)
    return state, [reason for _, reason in answer.refusals]


def event(name: str, words: dict[str, Any], comes: bool = True) -> FaultEvent:
    return FaultEvent(name, read_fault_words(words), comes)


def test_the_last_string_is_not_lost() -> None:
    """The plant ended with a traceback."""
    state, refused = told(plant().initial_state(), 1, event("a", WORDS[0]))
    assert not refused
    state, refused = told(state, 2, event("b", WORDS[0]))
    said = f"{FAULTS_TOPIC}.strings = 1: allowed is fewer than the 1 that battery still has: it cannot be without any"
    assert refused == [said]
    assert [one.name for one in state.faults] == ["a"]
    ticks = state.machine.tick
    state, refused = told(state, 3)
    assert not refused and state.machine.tick == ticks + 1
    assert plant().heartbeat_values(state, 3 * CONTROL_PERIOD_NS)["faults"] == "a"


def test_of_two_in_one_period_the_first_is_taken() -> None:
    state, refused = told(plant().initial_state(), 1, event("a", WORDS[1]), event("b", WORDS[1]))
    assert len(refused) == 1 and [one.name for one in state.faults] == ["a"]


def test_a_panel_that_stands_in_no_direction_is_refused() -> None:
    with pytest.raises(RefusedMessageError, match=r"/faults\.normal = \(0.0, 0.0, 0.0\): allowed is a direction"):
        told(plant().initial_state(), 1, event("a", {**WORDS[3], "normal": [0.0, 0.0, 0.0]}))


@settings(max_examples=25)
@given(
    said=st.lists(
        st.tuples(
            st.sampled_from("abcd"),
            st.sampled_from(WORDS) | st.sampled_from(WORDS[:2]),
            st.sampled_from((True, True, False)),
        ),
        max_size=12,
    )
)
def test_whatever_comes_and_goes_the_plant_goes_on(said: list[tuple[str, dict[str, Any], bool]]) -> None:
    state, expected = plant().initial_state(), dict[str, str]()
    for period, (name, words, comes) in enumerate(said, start=1):
        state, refused = told(state, period, event(name, words, comes))
        kind, others = words["kind"], [there for other, there in expected.items() if other != name]
        is_too_much = comes and kind in LIMITED and kind in others
        assert len(refused) == is_too_much
        if not comes:
            expected.pop(name, None)
        elif not is_too_much and kind != "sensor":
            expected.pop(name, None)
            expected[name] = kind
        assert {one.name: one.fault.kind for one in state.faults} == expected
