"""What the plant tells of its rates, held against its positions, where a wheel meets a step at speed."""

import numpy as np
import pinocchio as pin

from ros_messages import ros_message
from sojourn_config.scenario import load_scenario
from sojourn_contract.conformance.consistency import RateRule
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.stamps import CONTROL_PERIOD_NS, CONTROL_PERIOD_S
from sojourn_contract.topics import topic
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant
from sojourn_plant.truth import TruthMessages


def test_a_rover_at_a_step_keeps_the_contract() -> None:
    """The LRV at 2.5 m/s: the mean velocity of a period is off the told one by the told spread at most.

    Its wheels at the edge of the step were told as two violations.
    """
    model, state = build_plant(load_scenario("lrv_course", ["start.x=13.5", "steps=[]"]))
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    wheels = model.reference_rows([wheel.joint for wheel in model.machine.wheels])
    columns = model.joints.columns[wheels]
    radii = np.array([wheel.shear_radius for wheel in model.machine.wheels])
    truth, found, jolts = TruthMessages(model), [], []
    rules = {name: RateRule(topic(name)) for name in ("/truth/odom", "/truth/joint_states")}
    for period in range(1, 301):
        command.reference[1, wheels] = min(period * CONTROL_PERIOD_S, 2.5) / radii
        before, angles, rates = state.configuration[:3], state.joints[0, wheels], state.velocity[columns]
        turning, speed = np.linalg.norm(state.velocity[3:6]), np.linalg.norm(state.velocity[:3])
        state, output = step(model, state, command)
        moved = pin.Quaternion(state.configuration[3:7]).toRotationMatrix().T @ (state.configuration[:3] - before)
        off = np.abs(moved / CONTROL_PERIOD_S - state.velocity[:3])
        turning = max(turning, np.linalg.norm(state.velocity[3:6]))
        turned = turning * CONTROL_PERIOD_S * max(speed, np.linalg.norm(state.velocity[:3]))
        assert np.all(off <= output.spread[:3] + turned + 1e-6)
        mean, ends = (state.joints[0, wheels] - angles) / CONTROL_PERIOD_S, np.array((rates, state.velocity[columns]))
        jolts.append(np.max(np.abs(mean - ends.mean(axis=0)) - np.abs(ends[1] - ends[0])))
        stamp = period * CONTROL_PERIOD_NS
        for name, message in truth.messages(stamp, state, output):
            if name in rules:
                found += rules[name].judge(Observation(topic(name), ros_message(message), stamp, None, stamp))
    assert state.configuration[0] > 20.0, "it is over the step"
    assert max(jolts) > 0.01, "and has felt it: within the period, more than its ends tell"
    assert not found, found[0]
