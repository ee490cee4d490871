"""Gears with play and give: rest on a flank, the way between flanks, two masses that swing, energy, the stiff limit."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from joint_bench import Bench

from sojourn_physics.actuators import joint_drive as jd

ARM: dict[str, Any] = {
    "kind": jd.POSITION, "ratio": 2000.0, "max_current": 1.5, "efficiency": 0.7, "friction": 2.7, "viscous": 2.0,
    "proportional": 5000.0, "integral": 5000.0, "derivative": 400.0, "max_torque": 60.0, "rotor": 1.08e-6,
    "inertia": 0.8, "half_gap": 3e-4, "tooth_stiffness": 2.5e4, "tooth_damping": 30.0, "bearing_friction": 0.3,
    "bearing_viscous": 1.0,
}  # fmt: skip
"""An arm joint of the explorer."""


def settled(**options: Any) -> Bench:
    bench = Bench(**{**ARM, **options})
    bench.command[0, 0] = 0.02
    bench.step(8000)
    return bench


@pytest.mark.parametrize("load", [-12.0, 12.0])
def test_a_load_rests_on_a_flank_and_bends_the_gear(load: float) -> None:
    """The motor is where it was told to be; the joint is off by half the play and the load over the stiffness."""
    bench = settled(load=load)
    angle, twist = bench.states[jd.ANGLE, 0], bench.states[jd.TWIST, 0]
    assert angle + twist == pytest.approx(0.02, abs=1e-5)
    carried = 12.0 - 0.3, 12.0 + 0.3  # the bearing may hold a part
    off = (twist + math.copysign(3e-4, load)) * -math.copysign(1.0, load)
    assert carried[0] / 2.5e4 <= off <= carried[1] / 2.5e4
    before = abs(bench.rate)
    bench.step(8000)
    assert abs(bench.rate) < max(0.1 * before, 1e-12) < 1e-6, "what is left of the motion dies out"


def test_a_load_that_turns_round_takes_the_joint_to_the_other_flank() -> None:
    bench = settled(load=8.0)
    before = bench.states[jd.ANGLE, 0]
    bench.load = -8.0
    bench.step(20000)
    assert before - bench.states[jd.ANGLE, 0] == pytest.approx(2 * (3e-4 + 8.0 / 2.5e4), abs=4e-5)


def test_an_encoder_on_the_joint_sees_the_play() -> None:
    """Play moves the joint where the encoder is on the motor, and the motor where it is on the joint. No integral: with
    play it would hunt.
    """
    for sees_joint, moved in ((0.0, jd.ANGLE), (1.0, jd.TWIST)):
        little, much = (settled(load=-12.0, sees_joint=sees_joint, integral=0.0, half_gap=gap) for gap in (3e-4, 3e-3))
        change = much.states[:, 0] - little.states[:, 0]
        assert abs(change[moved]) == pytest.approx(2.7e-3, abs=2e-4)
        assert abs(change[jd.ANGLE] + (1.0 - sees_joint) * change[jd.TWIST]) < 2e-4
        assert abs(much.rate) < 1e-6


def test_two_masses_swing_at_their_frequency() -> None:
    """Fixed neither here nor there: omega^2 = k (1/J + 1/J_rotor)."""
    bench = Bench(inertia=0.5, rotor=1e-6, ratio=1000.0, tooth_stiffness=2e4, kind=jd.RATE, fraction=0.0, dt=2e-6)
    bench.states[jd.TWIST, 0] = 1e-3
    turns, last, times = 0, 1.0, []
    for k in range(60_000):
        bench.step()
        now = bench.states[jd.TWIST, 0]
        if now * last < 0.0:
            turns, times = turns + 1, [*times, k * bench.dt]
        last = now
    period = 2.0 * (times[-1] - times[0]) / (turns - 1)
    assert 2.0 * math.pi / period == pytest.approx(math.sqrt(2e4 * (1 / 0.5 + 1 / 1.0)), rel=2e-3)


def test_a_stiff_gear_without_play_is_none() -> None:
    stiff = {"half_gap": 0.0, "tooth_stiffness": 1e9, "tooth_damping": 0.0}
    stiff |= {"bearing_friction": 0.0, "bearing_viscous": 0.0}
    one, two = Bench(**{**ARM, **stiff}, load=-5.0), Bench(**{**ARM, "tooth_stiffness": 0.0}, load=-5.0)
    for bench in (one, two):
        bench.command[0, 0] = 0.05
        bench.step(300)
    assert one.rate == pytest.approx(two.rate, rel=2e-3)
    assert one.states[jd.ANGLE, 0] == pytest.approx(two.states[jd.ANGLE, 0], rel=2e-3)
    assert one.power == pytest.approx(two.power, rel=2e-3)


@settings(max_examples=60, deadline=None)
@given(
    half_gap=st.floats(0.0, 0.01),
    stiffness=st.floats(1e3, 1e6),
    damping=st.floats(0.0, 300.0),
    inertia=st.floats(0.01, 10.0),
    load=st.floats(-20.0, 20.0),
    target=st.floats(-0.2, 0.2),
    sees_joint=st.sampled_from([0.0, 1.0]),
)
def test_every_joule_is_accounted_for_and_nothing_runs_away(
    half_gap: float, stiffness: float, damping: float, inertia: float, load: float, target: float, sees_joint: float
) -> None:
    play = {"half_gap": half_gap, "tooth_stiffness": stiffness, "tooth_damping": damping, "inertia": inertia}
    bench = Bench(**{**ARM, **play}, load=load, sees_joint=sees_joint)
    bench.command[0, 0] = target
    bench.step(500)
    motor_rate = float(bench.states[jd.MOTOR_RATE, 0])
    kinetic = 0.5 * inertia * bench.rate**2 + 0.5 * 1.08e-6 * 2000.0**2 * motor_rate**2
    electrical, *heats = bench.energy
    terms = [electrical, bench.work, -kinetic, *(-heat for heat in heats)]
    assert abs(sum(terms)) <= 1e-9 * max(map(abs, terms)) + 1e-12
    assert np.isfinite(bench.states).all() and abs(motor_rate) < 1.0
