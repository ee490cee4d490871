"""Screws and gears: work in, work out, and what is lost in both senses."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from joint_bench import Bench

from sojourn_machine.drives import JointDriveParams
from sojourn_machine.screw import ScrewParams
from sojourn_physics.actuators import joint_drive as jd

DRIVE = {
    "joints": ["joint"],
    "load": "arm",
    "motor": {
        "resistance": 1.0, "torque_constant": 0.05, "rotor_inertia": 3e-5, "no_load_current": 0.1, "max_current": 5.0
    },
    "gear": {"ratio": 3.0, "efficiency": 0.8, "friction_torque": 2.0, "viscous_friction": 1.0},
    "servo": {"mode": "rate", "proportional": 1.0, "max_torque": 1000.0},
}  # fmt: skip


@given(lead=st.floats(1e-3, 0.02), friction=st.floats(0.0, 0.3))
def test_screw_work(lead: float, friction: float) -> None:
    part = ScrewParams(lead=lead, diameter=0.02, friction=friction, flank_deg=15.0)
    # the forces on the inclined plane: raising against gravity and friction, and letting down
    force, angle, rho = 1000.0, part.lead_angle, part.friction_angle
    normal = force / (math.cos(angle) - math.tan(rho) * math.sin(angle))
    raising = normal * (math.sin(angle) + math.tan(rho) * math.cos(angle)) * 0.01
    assert force * lead == pytest.approx(part.raising_efficiency * raising * 2.0 * math.pi)
    normal = force / (math.cos(angle) + math.tan(rho) * math.sin(angle))
    turning = normal * (math.sin(angle) - math.tan(rho) * math.cos(angle)) * 0.01
    assert turning * 2.0 * math.pi == pytest.approx(part.back_driving_efficiency * force * lead, abs=1e-9) or (
        part.locks_itself and turning <= 1e-9 and part.back_driving_efficiency == 0.0
    )


def test_a_drive_with_a_screw_moves_a_way() -> None:
    screw = {"lead": 0.01, "diameter": 0.02, "friction": 0.0172}
    drive = JointDriveParams.model_validate(DRIVE | {"screw": screw})
    assert drive.transmission.ratio == pytest.approx(3.0 * 200.0 * math.pi)
    assert drive.transmission.efficiency == pytest.approx(0.8 * 0.9, rel=1e-3)
    # 5 A make 0.25 N m, 0.75 N m behind the gear, and that over 0.01 m a turn
    assert drive.motor_effort == pytest.approx(0.75 * 2.0 * math.pi / 0.01)
    assert drive.reflected_inertia == pytest.approx(3e-5 * drive.transmission.ratio**2)
    assert drive.screw is not None
    assert drive.transmission.back_efficiency == pytest.approx(drive.screw.back_driving_efficiency / 1.2)
    stiff = {"lead": 0.002, "diameter": 0.02, "friction": 0.15}
    with pytest.raises(ValueError, match="with a brake"):
        JointDriveParams.model_validate(DRIVE | {"screw": stiff})
    braked = JointDriveParams.model_validate(DRIVE | {"screw": stiff, "brake": {"holding_torque": 0.5}})
    assert braked.transmission.back_efficiency == 0.5  # the brake holds what the screw does
    with pytest.raises(ValueError, match="back_efficiency"):
        JointDriveParams.model_validate(DRIVE | {"gear": {**DRIVE["gear"], "back_efficiency": 0.4}})
    with pytest.raises(ValueError, match="right angle"):
        ScrewParams(lead=1.0, diameter=0.001, friction=1.0)


def lowered(efficiency: float, back: float, load: float) -> tuple[float, float]:
    """Power of a load that drives a joint at a steady rate, and what arrives at the motor."""
    loss = 1.0 / back - 1.0 - (1.0 - efficiency)
    bench = Bench(ratio=50.0, efficiency=efficiency, back_loss=loss, proportional=200.0, voltage=1e4, load=load)
    bench.command[1] = 0.5 if load > 0.0 else -0.5  # let down at a rate
    bench.step(3000)
    motor = bench.ratio * bench.torque_constant * bench.current
    return load * float(bench.velocity[0]), -motor * float(bench.velocity[0])


@settings(max_examples=15, deadline=None)
@given(efficiency=st.floats(0.55, 0.95), back=st.floats(0.5, 0.95), load=st.sampled_from([-8.0, 8.0]))
def test_a_load_that_drives_meets_the_other_efficiency(efficiency: float, back: float, load: float) -> None:
    given_in, arrives = lowered(efficiency, back, load)
    assert given_in > 0.0 and arrives == pytest.approx(back * given_in, rel=2e-3)


def test_a_motor_that_drives_meets_its_own_efficiency() -> None:
    bench = Bench(ratio=50.0, efficiency=0.7, back_loss=1.0, proportional=200.0, voltage=1e4, load=-8.0)
    bench.command[1] = 0.5
    bench.step(3000)
    motor = bench.ratio * bench.torque_constant * bench.current
    # F = (1 - n) |T|: what is left of the motor's torque is n of it
    assert 0.7 * motor == pytest.approx(8.0, rel=2e-3)


def test_a_held_joint_of_such_a_gear_rests() -> None:
    """Loaded and held in position, nothing moves: the sense that the friction remembers stands still too."""
    bench = Bench(
        kind=jd.POSITION, ratio=50.0, efficiency=0.7, back_loss=1.0, friction=0.2, proportional=2e3, derivative=20.0,
        voltage=1e4, load=5.0, inertia=0.1,
    )  # fmt: skip
    bench.step(20_000)
    place, current = float(bench.states[jd.ANGLE, 0]), bench.current
    bench.step(2000)
    assert float(bench.states[jd.ANGLE, 0]) == pytest.approx(place, abs=1e-10)
    assert bench.current == pytest.approx(current, rel=1e-6)
    assert np.abs(bench.velocity).max() < 1e-9
