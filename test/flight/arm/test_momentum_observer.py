"""The momentum observer against its own law, on a motion with a force at the tip of which the model knows nothing."""

from typing import Any

import numpy as np

from sojourn_flight.arm.contact_guard import JointReading, MomentumObserver, observe
from sojourn_flight.arm.dynamics import rigid_effort
from sojourn_flight.arm.kinematics import forward_kinematics

LEVEL = np.array([0.0, 0.0, -1.62])


def test_the_residual_is_the_torque_from_outside(explorer: Any) -> None:
    """r' = K (tau_ext - r)."""
    model, dt, rate = explorer.model, 0.002, 15.0
    force, observer = np.array([5.0, -8.0, 20.0]), MomentumObserver()
    mean = np.array(explorer.params.named_poses["unfold"])
    lagged = np.zeros(model.joint_count)
    for k in range(1500):
        phase = 1.3 * k * dt + np.arange(model.joint_count)
        q, qd, qdd = mean + 0.3 * np.sin(phase), 0.39 * np.cos(phase), -0.507 * np.sin(phase)
        outside = forward_kinematics(model, q).jacobian[:3].T @ force
        effort = rigid_effort(model, q, qd, qdd, LEVEL) - outside
        observer = observe(model, observer, True, JointReading(q, qd, effort), LEVEL, rate, dt)
        lagged = lagged + dt * rate * (outside - lagged)
    assert observer.residual is not None
    np.testing.assert_allclose(observer.residual, lagged, atol=0.02 * np.abs(lagged).max())
