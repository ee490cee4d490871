"""Defects in what drive, arm and power manager do where something is wrong with the machine, its ground, or its words.

They stand in the list of `app_defects`, and are put in as those are.
"""

from typing import Any

from app_defects import (
    Patch,
    change_params,
    changed,
    defect,
    hear,
    swap,
    with_number,
    without_task,
)

import sojourn_arm.app
import sojourn_drive.app
import sojourn_flight.arm.controller
import sojourn_flight.arm.tasks.joint_watch
import sojourn_flight.power_manager.string_watch
import sojourn_flight.power_manager.switch_watch
import sojourn_flight.supervision.drive
import sojourn_power.app
from sojourn_flight.hazards.keep_out import KeepOut

# Arm


@defect("drill", "arm", "/arm_command.position")
def a_hole_is_drilled_twice_as_deep(app: Any, patch: Patch) -> None:
    hear(app, patch, "/arm/task", lambda task: with_number(task, "depth", lambda depth: 2.0 * depth))


@defect("gripper", "arm", "/arm_command.effort")
def fingers_close_with_half_the_force(app: Any, patch: Patch) -> None:
    hear(app, patch, "/arm/task", lambda task: with_number(task, "force", lambda force: 0.5 * force))


@defect("arm_faults", "arm", "/arm/status.status.values.failed_joints")
def a_joint_that_stands_still_is_not_noticed(app: Any, patch: Patch) -> None:
    patch.setattr(sojourn_flight.arm.controller, "stands_still", lambda *given: False)


@defect("arm_again", "arm", "/arm/status.status.values.failed_joints")
def a_joint_that_dies_under_a_task_is_not_noticed(app: Any, patch: Patch) -> None:
    patch.setattr(sojourn_flight.arm.tasks.joint_watch, "stands_still", lambda *given: False)


@defect("arm_again", "arm", "/arm/status.status.values.failed_joints")
def an_arm_that_is_started_again_knows_of_no_dead_joint(app: Any, patch: Patch) -> None:
    patch.setattr(sojourn_arm.app, "dead_of", lambda kept, model: ())


@defect("redundant", "arm", "/arm_command.position")
def joints_to_spare_are_left_alone(app: Any, patch: Patch) -> None:
    swap(patch, app, "params", changed(app.params, "secondary_task", lambda _: "none"))


@defect("table", "arm", "/arm_command.velocity")
def the_arm_takes_more_power_than_it_may(app: Any, patch: Patch) -> None:
    swap(patch, app, "params", changed(app.params, "power_limit", lambda limit: 10.0 * limit))


@defect("touch", "arm", "/arm_command.velocity")
def a_led_tip_is_not_paused(app: Any, patch: Patch) -> None:
    hear(app, patch, "/arm/task", without_task("pause"))


@defect("touch", "arm", "/arm_command.position")
def the_arm_does_not_give_way(app: Any, patch: Patch) -> None:
    swap(patch, app, "params", changed(app.params, "contact.force", lambda force: 10.0 * force))


@defect("round", "arm", "/arm/status.status.values.goals_refused")
def a_rock_that_was_seen_is_forgotten(app: Any, patch: Patch) -> None:
    hear(app, patch, "/hazcam/points", lambda cloud: None)


@defect("wrong_words", "arm", "/arm/status.status.values.reason")
def wrong_tasks_are_not_answered(app: Any, patch: Patch) -> None:
    hear(app, patch, "/arm/task", lambda task: None)


# Drive


@defect("wrong_words", "drive", "/drive/status.status.values.reason")
def wrong_goals_are_not_answered(app: Any, patch: Patch) -> None:
    hear(app, patch, "/goal_pose", lambda goal: None)


@defect("restarts", "drive", "/odom.pose.covariance")
def a_restarted_drive_is_as_sure_as_before(app: Any, patch: Patch) -> None:
    patch.setattr(sojourn_drive.app, "less_sure", lambda estimate, way, turn: estimate)


@defect("restarts", "drive", "/drive/status.status.values.reason")
def a_goal_that_a_restart_has_lost_is_not_told(app: Any, patch: Patch) -> None:
    kept = sojourn_drive.app.DriveApp.to_keep
    told = lambda app, state: {**kept(app, state), "goal": {}}  # noqa: E731
    patch.setattr(sojourn_drive.app.DriveApp, "to_keep", told)


@defect("loose", "drive", "/drive_command.velocity")
def slip_does_not_slow_the_rover(app: Any, patch: Patch) -> None:
    change_params(app, patch, "slip_policy", lambda policy: None)


@defect("astern", "drive", "/drive/status.status.values.reason")
def a_dead_wheel_is_never_drawn_behind(app: Any, patch: Patch) -> None:
    patch.setattr(app.model.mobility, "rather_astern", lambda state: False)


@defect("keep_out", "drive", "/drive/status.status.values.asked_reason")
def zones_are_forgotten(app: Any, patch: Patch) -> None:
    swap(patch, app.model, "avoidance", changed(app.model.avoidance, "keep_out", lambda zones: KeepOut(())))


@defect("keep_out", "drive", "/drive_command.velocity")
def a_dusty_camera_is_trusted(app: Any, patch: Patch) -> None:
    patch.setattr(sojourn_flight.supervision.drive, "speed_left", lambda params, camera: 1.0)


@defect("closed", "drive", "/drive_command.velocity")
def it_backs_off_at_half_its_speed(app: Any, patch: Patch) -> None:
    params = changed(app.model.avoidance.params, "back_off_speed", lambda speed: 0.5 * speed)
    swap(patch, app.model, "avoidance", changed(app.model.avoidance, "params", lambda _: params))


# Power


@defect("strings", "power", "/power/status.status.values.faults")
def a_failed_string_is_not_told(app: Any, patch: Patch) -> None:
    patch.setattr(sojourn_flight.power_manager.string_watch, "step", lambda *given: given[2])


@defect("strings", "power", "/power/status.status.values.faults")
def a_stuck_switch_is_not_told(app: Any, patch: Patch) -> None:
    patch.setattr(sojourn_flight.power_manager.switch_watch, "_judged", lambda *given: ())


@defect("strings", "power", "/power/status.status.values.soc_sigma")
def voltages_are_trusted_too_much(app: Any, patch: Patch) -> None:
    manager = app._app  # it is restarted, and so among the disturbances of its run
    swap(patch, manager, "params", changed(manager.params, "law.kalman.voltage_noise", lambda noise: 0.1 * noise))


@defect("strings", "power", "/power/switches.status.values.computer")
def a_restarted_manager_knows_nothing_of_sleep(app: Any, patch: Patch) -> None:
    patch.setattr(sojourn_power.app, "started_again", lambda params, heat, state, stamp, kept: state)


@defect("night", "power", "/power/status.status.values.request")
def a_restarted_manager_forgets_what_was_asked(app: Any, patch: Patch) -> None:
    patch.setattr(sojourn_power.app.PowerApp, "to_keep", lambda app, state: {})


@defect("dust", "power", "/power/status.status.values.arrays_clean")
def dust_is_not_believed(app: Any, patch: Patch) -> None:
    patch.setattr(sojourn_power.app.Forecaster, "clean_after", lambda forecaster, known: known.clean)


@defect("wrong_words", "power", "/power/status.status.values.request_reason")
def wrong_requests_are_not_answered(app: Any, patch: Patch) -> None:
    hear(app, patch, "/power/request", lambda asked: None)
