"""Control laws in the simulated loop: each does what theory says of it, the loop itself has its checks."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from frictionless import no_friction
from sojourn_analysis.arm.control_loop import (
    ControlTestError,
    LoopResult,
    LoopSettings,
    comparison_motion,
    gain_margin,
    run,
    settings_for,
)
from sojourn_config.arms import load_arm
from sojourn_flight.arm.control_laws import LAWS, MeasuredJoints, Reference, effort_of, feedback_of, gains_for
from sojourn_flight.arm.dynamics import gravity_effort
from sojourn_flight.arm.profiles import joint_motion
from sojourn_flight.arm.serial_arm import with_motors, with_scaled_masses
from sojourn_machine.errors import InvalidValueError

EARTH = np.array([0.0, 0.0, -9.81])
PUMA = load_arm("puma560")
START, GOAL = np.array([0.0, 0.6, -2.4, 0.1, 0.5, 0.0]), np.array([0.3, 0.9, -2.1, 0.4, 0.8, 0.3])
MOTION = joint_motion("quintic", START, GOAL, PUMA.max_velocity, np.full(6, 2.0))
SETTINGS = LoopSettings(bandwidth=25.0, sample_time=0.004, settle=0.3)


@pytest.fixture(scope="module")
def results() -> dict[str, LoopResult]:
    """Every law with the right model."""
    return {law: run(law, PUMA, PUMA, MOTION, EARTH, SETTINGS) for law in LAWS}


def test_models_beat_gains_and_integrals_take_out_what_stays(results: dict[str, LoopResult]) -> None:
    rms = {law: result.tip_rms for law, result in results.items()}
    assert rms["computed_torque"] < 0.1 * rms["pd"] and rms["feedforward"] < 0.1 * rms["pd"]
    assert rms["pd_gravity"] < rms["pd"]
    assert results["pid"].final_tip_error < 0.5 * results["pd"].final_tip_error
    for law, result in results.items():
        assert not result.unstable and result.saturated < 0.05, law


def test_wrong_masses_cost_and_feedback_limits_the_cost(results: dict[str, LoopResult]) -> None:
    wrong = with_scaled_masses(PUMA, np.full(6, 1.2))
    open_loop = run("open_loop", PUMA, wrong, MOTION, EARTH, SETTINGS)
    closed = run("feedforward", PUMA, wrong, MOTION, EARTH, SETTINGS)
    assert open_loop.tip_rms > 5.0 * closed.tip_rms > 5.0 * results["feedforward"].tip_rms
    assert closed.tip_rms < 0.005


def test_pd_at_rest_sags_by_the_weight_over_the_gain() -> None:
    """Without friction, the end error of a PD is that at which the spring holds the weight."""
    free = with_motors(PUMA, PUMA.motor_inertia, no_friction(6))
    still = joint_motion("quintic", GOAL, GOAL + 1e-9, PUMA.max_velocity, np.full(6, 2.0))
    settings = LoopSettings(bandwidth=25.0, sample_time=0.004, encoder_bits=30, settle=1.0)
    gains = gains_for(free, GOAL, 25.0)
    result = run("pd", free, free, still, EARTH, settings)
    sag = np.max(np.abs(gravity_effort(free, GOAL, EARTH) / gains.proportional))
    assert result.largest_joint_error == pytest.approx(sag, rel=0.1)
    held = run("pd_gravity", free, free, still, EARTH, settings)
    assert held.largest_joint_error < 0.01 * sag


def test_energy_of_an_open_loop_is_the_work_of_the_motion(results: dict[str, LoopResult]) -> None:
    from sojourn_flight.arm.dynamics import inverse_dynamics

    times, work = np.linspace(0.0, MOTION.duration, 2001), 0.0
    for time in times:
        q, qd, qdd = MOTION.sample(float(time))
        work += float(np.sum(np.maximum(inverse_dynamics(PUMA, q, qd, qdd, EARTH) * qd, 0.0))) * times[1]
    assert results["computed_torque"].energy == pytest.approx(work, rel=0.03)


def test_computed_torque_is_a_double_integrator_whose_margin_is_known() -> None:
    """With the right model every joint is the same sampled loop: its margin from a 2 x 2 problem, worked out here."""
    free = with_motors(PUMA, PUMA.motor_inertia, no_friction(6))
    t, w = SETTINGS.sample_time, SETTINGS.bandwidth

    def radius(factor: float) -> float:
        step = expm(np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]) * t)
        law = -factor * np.array([w * w + 2 * w / t, 0.0, -2 * w / t, 0.0])
        loop = np.zeros((4, 4))  # q, qd, last q, waiting effort
        loop[:2, :2], loop[:2, 3] = step[:2, :2], step[:2, 2]
        loop[2, 0], loop[3] = 1.0, law
        return float(np.max(np.abs(np.linalg.eigvals(loop))))

    margin = gain_margin("computed_torque", free, free, gains_for(free, GOAL, w), GOAL, SETTINGS)
    assert radius(0.999 * margin) < 1.0 < radius(1.001 * margin)
    assert 1.5 < margin < 10.0


def test_beyond_its_margin_the_simulated_loop_is_lost() -> None:
    """The margin is of the linearised loop; the simulation, which knows nothing of it, agrees on both sides."""
    free = with_motors(PUMA, PUMA.motor_inertia, no_friction(6))
    strong = with_motors(free, free.motor_inertia, free.friction)
    factor = gain_margin("computed_torque", free, free, gains_for(free, GOAL, 25.0), GOAL, SETTINGS)
    # gains grow with the square of the bandwidth: a model that is heavier raises all of them alike
    for share, lost in ((0.7, False), (1.6, True)):
        model = with_scaled_masses(with_motors(strong, share * factor * free.motor_inertia, free.friction),
                                   np.full(6, share * factor))  # fmt: skip
        result = run("computed_torque", free, model, MOTION, np.zeros(3), SETTINGS)
        assert (result.saturated > 0.5) == lost


def test_delay_takes_margin() -> None:
    gains = gains_for(PUMA, GOAL, 25.0)
    margins = [
        gain_margin("pd", PUMA, PUMA, gains, GOAL, LoopSettings(25.0, 0.004, delay=delay)) for delay in (0, 1, 2, 4)
    ]
    assert margins == sorted(margins, reverse=True) and margins[-1] < 0.6 * margins[0]
    assert math.isinf(gain_margin("open_loop", PUMA, PUMA, gains, GOAL, SETTINGS))


@pytest.mark.parametrize("law", LAWS)
def test_feedback_matrices_are_the_slopes_of_the_law(law: str) -> None:
    gains, h = gains_for(PUMA, GOAL, 25.0), 1e-6
    at_rest = Reference(GOAL, np.zeros(6), np.zeros(6))
    position, velocity = feedback_of(law, PUMA, gains, GOAL)  # type: ignore[arg-type]

    def effort(q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        return effort_of(law, PUMA, gains, at_rest, MeasuredJoints(q, qd, np.zeros(6)), np.zeros(3))  # type: ignore[arg-type]

    for i, step in enumerate(np.eye(6) * h):
        by_position = (effort(GOAL + step, np.zeros(6)) - effort(GOAL - step, np.zeros(6))) / (2 * h)
        by_velocity = (effort(GOAL, step) - effort(GOAL, -step)) / (2 * h)
        np.testing.assert_allclose(by_position, -position[:, i], atol=1e-5 * gains.proportional.max())
        np.testing.assert_allclose(by_velocity, -velocity[:, i], atol=1e-5 * gains.derivative.max())


def test_every_arm_has_a_motion_and_a_loop() -> None:
    for name in ("explorer_arm", "scara", "cylindrical"):
        arm = load_arm(name)
        settings = settings_for(arm, 0.5 * (arm.lower + arm.upper))
        motion = comparison_motion(arm, EARTH, 20.0 / settings.bandwidth)
        assert not run("computed_torque", arm, arm, motion, EARTH, settings).unstable
    with pytest.raises(ControlTestError, match="srms has not the effort"):
        comparison_motion(load_arm("srms"), EARTH, 10.0)
    with pytest.raises(InvalidValueError, match="loop settings"):
        run("pd", PUMA, PUMA, MOTION, EARTH, LoopSettings(25.0, 0.004, delay=-1))
