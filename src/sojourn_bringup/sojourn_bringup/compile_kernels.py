"""Has every kernel compiled and kept, so that no run waits for the compiler: one step of each model of a scenario."""

import numpy as np

from sojourn_config.load import load_params
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_mechanics.arm import controller
from sojourn_mechanics.arm.model import build_arm_model
from sojourn_mechanics.contact.wheel_bench import measure
from sojourn_mechanics.contact.wheel_shape import WheelShape
from sojourn_mechanics.plant.state import zeros_command
from sojourn_mechanics.plant.step import step
from sojourn_mechanics.power import manager
from sojourn_mechanics.sensors import suite
from sojourn_mechanics.soil.params import SoilParams
from sojourn_mechanics.steering.drive import DriveModel
from sojourn_mechanics.steering.drive_types import DriveInput
from sojourn_mechanics.steering.goal import Goal
from sojourn_plant.start import build_plant

SCENARIO = "lunar_sample"
"""Has all kinds of ground in it."""
PERIOD = 0.02


def main() -> None:
    """Compile; prints nothing, takes about a minute the first time and some seconds after."""
    scenario = load_scenario(SCENARIO)
    _step_plant(scenario)
    _step_sensors(scenario)
    _step_drive(scenario)
    wheel = load_params("wheels", "explorer", WheelShape)
    measure(wheel, load_params("soils", "cmu_sand", SoilParams), load=50.0, slips_of_carriage=[0.2])
    controller.warm_up(scenario.arm, build_arm_model(scenario.urdf_xml, scenario.arm))
    manager.step(
        scenario.power_manager,
        manager.initial_state(scenario.power_manager),
        manager.PowerManagerInput(voltage=28.0, current=1.0, temperature=290.0),
        PERIOD,
    )


def _step_plant(scenario: LoadedScenario) -> None:
    model, state = build_plant(scenario)
    step(model, state, zeros_command(len(model.joints.names), len(model.bus.loads)))


def _step_sensors(scenario: LoadedScenario) -> None:
    joints = tuple(joint for group in scenario.sensors.joint_groups.values() for joint in group.joints)
    zeros = np.zeros(len(joints))
    still = np.array([0.0, 0.0, 0.0, 1.0])
    state = suite.initial_state(scenario.sensors, 0, joints, zeros, ("battery",), still, scenario.gravity)
    up = np.array([0.0, 0.0, scenario.gravity])
    one = np.ones(1)
    truth = suite.SensorTruth(zeros, zeros, np.zeros(3), up, 28.0 * one, one, 290.0 * one)
    suite.step(scenario.sensors, state, truth, PERIOD)


def _step_drive(scenario: LoadedScenario) -> None:
    model = DriveModel(scenario.drive, scenario.steering)
    wheels = np.zeros(len(scenario.steering.wheels))
    state = model.initial_state()
    for goal in (Goal.at(1.0, 1.0), None):
        turning = DriveInput(wheels, wheels, wheels, gyro=(0.0, 0.0, 0.1), roll_pitch=(0.0, 0.0), goal=goal)
        state, _ = model.step(state, turning, PERIOD)
    resting = DriveInput(wheels, wheels, wheels, gyro=(0.0, 0.0, 0.0), roll_pitch=(0.0, 0.0), stop=True)
    for _ in range(round(2.0 * scenario.drive.odometry.standing_time / PERIOD)):
        state, _ = model.step(state, resting, PERIOD)


if __name__ == "__main__":
    main()
