"""Joint drives: DC motors against their catalogue and closed forms, friction, stops, energy."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from joint_bench import Bench

from sojourn_physics.actuators import joint_drive as jd

RE_25 = {"resistance": 2.32, "torque_constant": 0.0234, "rotor": 10.8e-7, "no_load_current": 0.0369}
RE_40 = {"resistance": 0.299, "torque_constant": 0.0302, "rotor": 142e-7, "no_load_current": 0.137}
"""maxon RE 25 and RE 40, 24 V (catalogue)."""


def motor(data: dict[str, float], **options: float) -> Bench:
    """A catalogue motor without gear, driven at full voltage."""
    constant = data["torque_constant"]
    bench = Bench(
        resistance=data["resistance"],
        torque_constant=constant,
        friction=data["no_load_current"] * constant,
        rotor=data["rotor"],
        proportional=1e3,
        **options,  # type: ignore[arg-type]
    )
    bench.command[1, 0] = 1e5
    return bench


@pytest.mark.parametrize(
    ("data", "stall_current", "stall_torque"),
    [(RE_25, 10.34, 0.242), (RE_40, 80.27, 80.27 * 0.0302)],
    ids=["RE 25", "RE 40"],
)
def test_stall_and_no_load_of_the_catalogue(data: dict[str, float], stall_current: float, stall_torque: float) -> None:
    stalled = motor(data, inertia=1e9)
    stalled.step()
    assert stalled.current == pytest.approx(stall_current, rel=1e-3)
    assert stalled.current * data["torque_constant"] == pytest.approx(stall_torque, rel=2e-3)
    free = motor(data, inertia=1e-6)
    free.step(500)
    drop = data["resistance"] * data["no_load_current"]
    assert free.rate == pytest.approx((24.0 - drop) / data["torque_constant"], rel=1e-6)
    assert free.current == pytest.approx(data["no_load_current"], rel=1e-6)


def test_best_efficiency_of_the_re_40() -> None:
    """Largest efficiency 0.919 (catalogue), (1 - sqrt(I0 / I_stall))², at the current sqrt(I0 I_stall)."""
    best = 0.0
    for current in np.linspace(1.0, 8.0, 36):
        bench = motor(RE_40, inertia=1e-6)
        bench.load = -(current - RE_40["no_load_current"]) * RE_40["torque_constant"]
        bench.step(500)
        best = max(best, -bench.load * bench.rate / bench.power)
    assert best == pytest.approx(0.919, abs=1e-3)


def test_mechanical_time_constant_of_the_re_40() -> None:
    """4.66 ms (catalogue) = R J / k²: the time to 63.2 % of the no-load speed."""
    bench = motor({**RE_40, "no_load_current": 0.0}, inertia=0.0, dt=1e-5)
    final = 24.0 / RE_40["torque_constant"]
    steps = 0
    while bench.rate < (1.0 - math.exp(-1.0)) * final:
        bench.step()
        steps += 1
    assert steps * 1e-5 == pytest.approx(4.66e-3, rel=5e-3)


@settings(max_examples=30, deadline=None)
@given(st.floats(1.0, 2000.0), st.floats(6.0, 36.0), st.floats(-0.9, 0.9))
def test_the_bus_voltage_is_the_line_of_torque_over_speed(ratio: float, voltage: float, part: float) -> None:
    """At full voltage V = R I + k N ω, whatever the load, in both directions."""
    bench = Bench(ratio=ratio, voltage=voltage, proportional=1e9, inertia=1e-6 * ratio**2)
    bench.command[1, 0] = 1e6
    stall = voltage / bench.resistance * bench.torque_constant * ratio
    bench.load = -part * stall
    bench.step(3000)
    back = bench.torque_constant * ratio * bench.rate
    assert bench.resistance * bench.current + back == pytest.approx(voltage, rel=1e-6)
    assert bench.current * bench.torque_constant * ratio == pytest.approx(-bench.load, rel=1e-4, abs=1e-6 * stall)


@pytest.mark.parametrize("fraction", [1.0, 0.25, 0.0])
def test_the_current_limit_follows_the_load_switch(fraction: float) -> None:
    bench = Bench(ratio=100.0, max_current=2.0, fraction=fraction, proportional=1e6, inertia=1e9)
    bench.command[1, 0] = 1.0
    bench.step()
    assert bench.current == pytest.approx(2.0 * fraction)
    assert bench.power == pytest.approx(2.32 * (2.0 * fraction) ** 2, abs=1e-9)


def test_driven_beyond_no_load_speed_the_current_stays_limited() -> None:
    bench = Bench(max_current=1.0, proportional=1e3, inertia=10.0)
    bench.velocity[0] = 5000.0
    bench.command[1, 0] = 5000.0
    bench.step(10)
    assert bench.current == pytest.approx(-1.0)
    assert bench.power < 0.0  # it feeds the bus


def test_rate_servo_settles_at_the_commanded_rate_under_load() -> None:
    bench = Bench(
        ratio=1000.0, rotor=1.08e-6, proportional=100.0, integral=200.0, inertia=1.0, friction=2.5, viscous=1.0,
        efficiency=0.7, max_torque=40.0,
    )  # fmt: skip
    bench.command[1, 0] = 0.5
    bench.load = -5.0
    bench.step(6000)
    assert bench.rate == pytest.approx(0.5, rel=1e-6)
    # the motor carries load and viscous friction, F0, and 30 % of itself
    assert bench.effort == pytest.approx(5.0, rel=1e-6)
    assert 23.4 * bench.current == pytest.approx((5.0 + 0.5 + 2.5) / 0.7, rel=1e-5)


def test_no_wind_up_at_the_limits() -> None:
    """A rate that cannot be had for ten seconds: asked for less, there is no overshoot to work off."""
    for limit in ({"max_torque": 5.0}, {"voltage": 10.0}):
        bench = Bench(ratio=1000.0, proportional=100.0, integral=200.0, inertia=5.0, **limit)  # type: ignore[arg-type]
        bench.load = -4.9 if "max_torque" in limit else 0.0
        bench.command[1, 0] = 5.0
        bench.step(10000)
        bench.load = 0.0
        bench.command[1, 0] = 0.2
        bench.step(1500)
        assert bench.rate == pytest.approx(0.2, abs=0.01)


def test_position_servo_holds_its_angle_under_load() -> None:
    bench = Bench(
        kind=jd.POSITION, ratio=2000.0, proportional=5000.0, derivative=400.0, integral=5000.0, inertia=20.0,
    )  # fmt: skip
    bench.command[:, 0] = [0.3, 0.0, 0.0]
    bench.load = -50.0
    bench.step(14000)
    assert bench.states[0, 0] == pytest.approx(0.3, abs=1e-5)
    assert bench.rate == pytest.approx(0.0, abs=1e-6)


def test_friction_holds_below_breakaway_and_rests() -> None:
    bench = Bench(kind=jd.PASSIVE, friction=2.5, inertia=1.0)
    bench.load = 1.2  # put on at once, it swings to twice that
    bench.step(20000)
    angle = float(bench.states[0, 0])
    assert 0.0 < angle < 0.005
    bench.step(20000)
    assert abs(bench.states[0, 0] - angle) < 1e-9
    bench.load = 3.0
    bench.step(1000)
    assert bench.rate == pytest.approx(0.5, rel=0.05)  # (3.0 - 2.5) N m on 1 kg m² for 1 s


def test_a_held_joint_is_a_fixed_point() -> None:
    """Friction deflected by exactly the load and nothing moving: not one bit changes."""
    bench = Bench(kind=jd.PASSIVE, friction=2.0, inertia=1.0)
    bench.load = 1.0
    bench.states[2, 0] = -0.5 * jd.FRICTION_ANGLE
    bench.load = -1.0
    bench.step(1000)
    assert bench.states[2, 0] == -0.5 * jd.FRICTION_ANGLE
    assert bench.rate == 0.0 and bench.states[0, 0] == 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_stop_holds_and_pushes_only(sign: float) -> None:
    bench = Bench(kind=jd.PASSIVE, lower=-0.5, upper=0.5, inertia=5.0)
    bench.load = sign * 30.0
    bench.step(5000)
    assert sign * bench.states[0, 0] == pytest.approx(0.5 + 30.0 / 2e4, rel=1e-4)
    assert bench.energy[3] > 0.0
    bench.load = -sign * 30.0
    bench.step(200)
    assert sign * bench.rate == pytest.approx(-30.0 / 5.0 * 0.2, rel=0.05)


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from([jd.RATE, jd.POSITION, jd.PASSIVE]),
    st.floats(-2.0, 2.0),
    st.floats(-40.0, 40.0),
    st.floats(0.05, 20.0),
    st.floats(0.3, 1.0),
    st.floats(-3.0, 3.0),
)
def test_electrical_energy_is_heat_and_work(
    kind: int, command: float, load: float, inertia: float, efficiency: float, rate: float
) -> None:
    """Electrical + work of the load = winding, friction and stop heat + kinetic energy, for any motion."""
    bench = Bench(
        kind=kind, ratio=500.0, proportional=300.0, derivative=30.0, integral=100.0, max_torque=30.0, friction=1.0,
        viscous=0.5, efficiency=efficiency, inertia=inertia, max_current=2.0, lower=-1.5, upper=1.5,
    )  # fmt: skip
    bench.command[:2, 0] = command
    bench.load = load
    bench.velocity[0] = rate
    before = 0.5 * inertia * rate**2
    bench.step(2000)
    after = 0.5 * inertia * bench.rate**2
    electrical, winding, friction, stop = bench.energy
    scale = abs(electrical) + abs(bench.work) + before + winding + abs(friction) + 1e-6
    # rotor left out: it is the machine's
    assert electrical + bench.work - winding - friction - stop == pytest.approx(after - before, abs=1e-6 * scale)
    assert winding >= 0.0
    assert math.isfinite(electrical)
    if kind == jd.PASSIVE:
        assert electrical == 0.0 and bench.current == 0.0


STEERING = {
    "kind": jd.POSITION, "ratio": 2500.0, "rotor": 1.08e-6, "proportional": 4000.0, "integral": 2000.0,
    "derivative": 330.0, "efficiency": 0.65, "friction": 4.66, "viscous": 2.0, "max_torque": 40.0, "max_current": 1.0,
    "inertia": 0.5, "voltage": 28.0,
}  # fmt: skip
"""Of the explorer."""


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_drive_that_is_driven_backwards_holds_with_no_more_than_the_joint_bears(sense: float) -> None:
    """Friction of the gear holds with the motor there: 40 N m of it would be 40 + 4.7 + 35 % of 40 at the joint."""
    for effort, most in ((np.inf, 60.0), (40.0, 40.0)):
        bench = Bench(**STEERING, max_effort=effort)  # type: ignore[arg-type]
        bench.load = -70.0 * sense
        efforts = []
        for _ in range(400):
            bench.step()
            efforts.append(sense * bench.effort)
        assert bench.rate * sense < -0.01, "it gives way"
        assert max(efforts) == pytest.approx(most, rel=0.02)
    bench.load = -20.0 * sense  # a load that the motor can move against its friction: it takes back what it gave
    bench.step(9000)
    assert bench.effort == pytest.approx(20.0 * sense, abs=0.05)
    assert abs(bench.states[0, 0]) < 1e-3


def test_a_drive_behind_its_reference_catches_up_within_the_rate_of_the_joint() -> None:
    for limit, least, most in ((np.inf, 0.45, 0.48), (0.35, 0.32, 0.35)):
        bench = Bench(**STEERING, max_rate=limit)  # type: ignore[arg-type]
        bench.command[0, 0] = 0.5
        rates = []
        for _ in range(4000):
            bench.step()
            rates.append(bench.rate)
        assert least < max(rates) <= most
        assert bench.states[0, 0] == pytest.approx(0.5, abs=2e-3)
    bench = Bench(kind=jd.RATE, proportional=100.0, integral=200.0, inertia=1.0, max_rate=1.0, ratio=1000.0)
    bench.command[1, 0] = -3.0
    bench.step(3000)
    assert bench.rate == pytest.approx(-1.0, rel=1e-4)
