"""Has every kernel compiled and kept, so that no run waits for the compiler: one step of each model of a scenario."""

import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np

from sojourn_analysis.arm.workspace import tip_samples
from sojourn_analysis.vehicle.law_wheel import LawWheel
from sojourn_analysis.wheels.wheel_bench import measure
from sojourn_config.arms import load_arm
from sojourn_config.load import load_params
from sojourn_config.scenario import load_scenario
from sojourn_contract.topics import ROLES
from sojourn_flight.arm.inverse import pose_goal
from sojourn_flight.arm.spline_path import spline_through
from sojourn_flight.arm.time_optimal import JointLimits, fastest_timing
from sojourn_flight.mobility.kinematics import allowed_twist
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_machine.contact_choice import CONTACT_LAWS, FOOT_LAWS
from sojourn_physics.contact.law_call import row_entry
from sojourn_physics.contact.law_params import ContactLawParams
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step
from sojourn_physics.soil.params import SoilParams
from sojourn_physics.terrain import earthwork
from sojourn_plant.start import build_plant
from sojourn_stack.apps import make_apps
from sojourn_stack.stack import PLANT

SCENARIO = "lunar_sample"
"""Has all kinds of ground in it."""
WITH_HEAT = "lunar_night"
"""Has light on arrays, and heat of the ground and of the machine, in it."""
WITH_CAMERAS = "machine=explorer_cameras"
WITH_LIDAR = (
    "sensors.scanner={kind: lidar, link: navcam_link, columns: 2, rows: 1, horizontal_view_deg: 10.0, "
    "vertical_view_deg: 0.0, nearest: 0.5, range: 50.0, noise: 0.01}"
)
WITH_BUMPER = "sensors.bumper={kind: bump_switch, link: navcam_link, width: 0.1, height: 0.1, travel: 0.01}"


def main() -> None:
    """Compile, on as many cores as there are; prints nothing, takes some minutes the first time and seconds after."""
    with ProcessPoolExecutor(min(len(PARTS), len(os.sched_getaffinity(0))), get_context("spawn")) as pool:
        for done in [pool.submit(part) for part in PARTS]:
            done.result()


def drive_plant() -> None:
    """The plant's step, and all laws of contact."""
    for kind in (laws.get(name) for laws in (CONTACT_LAWS, FOOT_LAWS) for name in laws.names()):
        if issubclass(kind, ContactLawParams):
            row_entry(kind.law())
    for name in (WITH_HEAT, SCENARIO):
        model, state = build_plant(load_scenario(name))
        step(model, state, zeros_command(len(model.joints.names), len(model.loads)))
    earthwork.warm_up(model.memory, model.terrain, model.grid)


def warm_apps() -> None:
    """What the apps of a run call."""
    apps = make_apps(load_scenario(SCENARIO), [role for role in ROLES if role != PLANT])
    for app in (*apps.values(), *make_apps(load_scenario(WITH_HEAT), ("power",)).values()):
        app.warm_up()


def see() -> None:
    """Sensors that look at the ground."""
    seeing = load_scenario(SCENARIO, [WITH_CAMERAS, WITH_LIDAR, WITH_BUMPER])
    make_apps(seeing, ("sensors",))["sensors"].warm_up()


def measure_wheels() -> None:
    """Wheels by themselves, as the tools of analysis have them."""
    scenario = load_scenario(SCENARIO)
    table = scenario.steering.table()
    allowed_twist(table, PlanarTwist(0.1, 0.0, 0.1), *np.zeros((2, len(table))))
    wheel = load_params("wheels", "explorer", WheelShape)
    measure(wheel, load_params("soils", "cmu_sand", SoilParams), load=50.0, slips_of_carriage=[0.2])
    LawWheel(scenario.machine.wheels[0], scenario.soil, scenario.gravity, greatest=0.005).forces(50.0, 0.1)


def plan_arm() -> None:
    """An arm that plans by itself."""
    arm = load_arm("puma560")
    pose_goal(arm, np.array([0.5, 0.1, 0.6]), np.eye(3))
    tip_samples(arm.chain, np.zeros((1, arm.joint_count)))
    path = spline_through(np.stack([arm.lower, arm.upper]), np.array([0.0, 1.0]))
    limits = JointLimits(arm.max_velocity, np.ones(arm.joint_count), arm.max_effort)
    fastest_timing(arm, path, limits, np.zeros(3), intervals=10)


PARTS = (drive_plant, warm_apps, see, plan_arm, measure_wheels)
"""Each by itself, the longest first. What two of them need both may compile: what is kept is the same."""


if __name__ == "__main__":
    main()
