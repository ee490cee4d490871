"""Defects of apps and flight laws, each put into an app of ours; the theme bags and the reference bag tell of each by
the field that is named. `defects.py` has those of nodes.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

import sojourn_drive.app
import sojourn_flight.mobility.rolling
import sojourn_power.app
from sojourn_contract.heartbeat import status_values

Patch = pytest.MonkeyPatch
SECOND = 1_000_000_000
SHORT = "short_goals"


@dataclass(frozen=True)
class AppDefect:
    """A defect.

    Args:
        name: what it is. bag, role: where it shows. field: by which. put_in: puts it into an app.
    """

    name: str
    bag: str
    role: str
    field: str
    put_in: Callable[[Any, Patch], None]


APP_DEFECTS: list[AppDefect] = []


def defect(bag: str, role: str, field: str) -> Callable[[Any], Any]:
    def note(put_in: Callable[[Any, Patch], None]) -> Callable[[Any, Patch], None]:
        name = bag if bag == SHORT else f"themes/{bag}"
        APP_DEFECTS.append(AppDefect(put_in.__name__, name, role, field, put_in))
        return put_in

    return note


# Ways to put a defect in


def swap(patch: Patch, owner: Any, name: str, value: Any) -> None:
    """Another value of an attribute, also of what is frozen."""
    patch.setitem(vars(owner), name, value)


def changed(value: Any, path: str, change: Callable[[Any], Any]) -> Any:
    """A value in which one far inside is another."""
    name, _, rest = path.partition(".")
    now = getattr(value, name)
    new = changed(now, rest, change) if rest else change(now)
    if hasattr(value, "model_copy"):
        return value.model_copy(update={name: new})
    return value._replace(**{name: new}) if hasattr(value, "_replace") else replace(value, **{name: new})


def change_params(app: Any, patch: Patch, path: str, change: Callable[[Any], Any]) -> None:
    """Another parameter of a drive, by its name in flight.yaml below `drive`, or of another app."""
    owner = app.model if hasattr(app, "model") and hasattr(app.model, "mobility") else app
    swap(patch, owner, "params", changed(owner.params, path, change))


def change_limits(app: Any, patch: Patch, name: str, factor: float) -> None:
    """Another limit of wheels and steering."""
    mobility = app.model.mobility
    swap(patch, mobility, "limits", changed(mobility.limits, name, lambda limit: factor * limit))


def hear(app: Any, patch: Patch, topic: str, change: Callable[[Any], Any]) -> None:
    """What the app hears on a topic is changed before it sees it; None: it does not hear it."""
    step = app.step

    def deaf(state: Any, period: Any) -> Any:
        inputs = {name: change(kept) if name == topic and kept else kept for name, kept in period.inputs.items()}
        goals = [(name, change(goal) if name == topic else goal) for name, goal in period.goals]
        return step(state, replace(period, inputs=inputs, goals=[pair for pair in goals if pair[1] is not None]))

    patch.setattr(app, "step", deaf)


def say(app: Any, patch: Patch, topic: str, change: Callable[[Any], Any]) -> None:
    """What the app says on a topic is changed."""
    step = app.step

    def altered(state: Any, period: Any) -> Any:
        state, answer = step(state, period)
        said = [(name, change(message) if name == topic else message) for name, message in answer.messages]
        return state, replace(answer, messages=said)

    patch.setattr(app, "step", altered)


def without_task(name: str) -> Callable[[Any], Any]:
    """A goal, or none where it is of this task."""
    return lambda message: None if message.status[0].name == name else message


def with_number(message: Any, key: str, change: Callable[[float], float]) -> Any:
    """A task with another number."""
    status = message.status[0]
    values = tuple((name, str(change(float(text))) if name == key else text) for name, text in status.values)
    return message._replace(status=(status._replace(values=values),))


# Limits of motion


@defect("by_hand", "drive", "/drive_command.position")
def the_rate_of_the_steering_is_not_limited(app: Any, patch: Patch) -> None:
    change_limits(app, patch, "max_steer_rate", 10.0)


@defect("by_hand", "drive", "/drive_command.velocity")
def the_steering_is_accelerated_twice_as_fast(app: Any, patch: Patch) -> None:
    change_limits(app, patch, "max_steer_acceleration", 2.0)


@defect("lrv", "drive", "/drive_command.position")
def the_limit_of_curvature_is_left_out(app: Any, patch: Patch) -> None:
    change_params(app, patch, "follower.max_curvature", lambda limit: 10.0 * limit)
    change_params(app, patch, "follower.planned_curvature", lambda limit: 10.0 * limit)


@defect("tracked", "drive", "/drive_command.velocity")
def acceleration_is_not_limited(app: Any, patch: Patch) -> None:
    change_limits(app, patch, "max_acceleration", 10.0)


@defect("tracked", "drive", "/drive_command.velocity")
def belts_brake_harder_than_allowed(app: Any, patch: Patch) -> None:
    change_limits(app, patch, "max_deceleration", 2.0)


@defect("omni", "drive", "/drive_command.velocity")
def wheels_turn_as_fast_as_they_like(app: Any, patch: Patch) -> None:
    change_limits(app, patch, "max_speed", 2.0)


@defect("lrv", "drive", "/drive/status.status.values.state")
def wheels_are_dragged_sideways(app: Any, patch: Patch) -> None:
    patch.setattr(app.model.mobility, "fit", lambda wanted: (wanted, ""))


# What operators say


@defect("skid", "drive", "/drive_command.velocity")
def a_velocity_counts_for_twice_its_time(app: Any, patch: Patch) -> None:
    change_params(app, patch, "cmd_vel_timeout", lambda limit: 2.0 * limit)


@defect("skid", "drive", "/drive_command.velocity")
def commands_do_not_age(app: Any, patch: Patch) -> None:
    command = sojourn_drive.app.TwistCommand
    patch.setattr(sojourn_drive.app, "TwistCommand", lambda twist, age: command(twist, 0.0))


@defect("omni", "drive", "/drive_command.velocity")
def left_is_taken_for_right(app: Any, patch: Patch) -> None:
    hear(app, patch, "/cmd_vel", lambda twist: twist._replace(linear=twist.linear * (1.0, -1.0, 1.0)))


@defect("skid", "drive", "/odom.pose.pose.orientation")
def an_operators_heading_is_not_taken(app: Any, patch: Patch) -> None:
    hear(app, patch, "/initialpose", lambda told: told._replace(orientation=np.array([0.0, 0.0, 0.0, 1.0])))


@defect("articulated", "drive", "/drive/status.status.values.reason")
def a_goal_is_not_heard(app: Any, patch: Patch) -> None:
    hear(app, patch, "/goal_pose", lambda goal: None)


@defect("by_hand", "drive", "/drive/status.status.values.asked_energy_wh")
def energy_is_forecast_a_tenth_too_low(app: Any, patch: Patch) -> None:
    change_params(app, patch, "energy.energy_per_metre", lambda costs: tuple(0.9 * cost for cost in costs))


@defect("interlock", "drive", "/drive_command.velocity")
def the_rover_drives_with_its_arm_out(app: Any, patch: Patch) -> None:
    patch.setattr(app._interlock, "why_not", lambda *given: "")


@defect("interlock", "arm", "/arm_command.position")
def the_arm_moves_while_the_rover_drives(app: Any, patch: Patch) -> None:
    rover = app._rover.rover
    patch.setattr(app._rover, "rover", lambda inputs: replace(rover(inputs), why_not_allowed=""))


@defect("interlock", "arm", "/arm_command.velocity")
def the_arm_does_not_stop_when_told(app: Any, patch: Patch) -> None:
    hear(app, patch, "/arm/stop", lambda stop: None)


# What the drive believes


@defect(SHORT, "drive", "/drive/status.status.values.power_limit")
def the_limit_of_power_is_not_kept(app: Any, patch: Patch) -> None:
    patch.setattr(app._measurements, "power_limit", lambda values, before: 1.0)


@defect("tracked", "drive", "/odom.pose.pose.position.x")
def slip_is_expected_half_of_what_it_is(app: Any, patch: Patch) -> None:
    odometry = app.model.params.odometry.model_copy(update={"mean_slip": 0.5 * app.model.params.odometry.mean_slip})
    change_params(app, patch, "odometry", lambda _: odometry)
    swap(patch, app.model.mobility, "_expected", odometry)


@defect("skid", "drive", "/odom.twist.twist.angular.z")
def the_bias_of_the_gyro_is_never_found(app: Any, patch: Patch) -> None:
    change_params(app, patch, "odometry.gyro_bias_sigma", lambda sigma: 1e-9)


@defect("by_hand", "drive", "/odom.pose.covariance")
def the_sun_is_not_looked_at(app: Any, patch: Patch) -> None:
    patch.setattr(app._sun, "sighting", lambda stamp, message, before: (None, before))


@defect("omni", "drive", "/odom.twist.twist.linear.x")
def wheels_are_thought_a_hundredth_larger(app: Any, patch: Patch) -> None:
    patch.setitem(vars(app.model.mobility), "table", app.model.mobility.table * (1.0 + 0.01 * _is_radius(app)))


def _is_radius(app: Any) -> Any:
    from sojourn_flight.mobility.wheel_table import WheelTableColumn

    marks = np.zeros(app.model.mobility.table.shape[1])
    marks[WheelTableColumn.RADIUS] = 1.0
    return marks


@defect("faults", "drive", "/drive/status.status.values.failed_motors")
def a_dead_motor_is_not_noticed(app: Any, patch: Patch) -> None:
    patch.setattr(sojourn_flight.mobility.rolling, "watch_motors", lambda *given: given[3])


@defect("steered", "drive", "/odom.twist.twist.linear.x")
def tilting_is_taken_for_the_bias_of_the_gyros(app: Any, patch: Patch) -> None:
    rolling = sojourn_flight.mobility.rolling
    estimate, unfelt = rolling.estimate_slip, np.zeros((2, 2))
    patch.setattr(
        rolling, "estimate_slip", lambda model, state, *now: estimate(model, state._replace(tilting=unfelt), *now)
    )


@defect("lrv", "drive", "/drive_command.position")
def a_path_is_followed_from_twice_as_near(app: Any, patch: Patch) -> None:
    change_params(app, patch, "follower.lateral_length", lambda length: 0.5 * length)


@defect("skid", "drive", "/drive_command.velocity")
def the_rover_comes_in_twice_as_fast(app: Any, patch: Patch) -> None:
    change_params(app, patch, "follower.approach_speed", lambda speed: 2.0 * speed)


# Arm


@defect("puma", "arm", "/arm_command.velocity")
def a_stop_is_not_heard(app: Any, patch: Patch) -> None:
    hear(app, patch, "/arm/stop", lambda stop: None)


@defect("puma", "arm", "/arm/status.status.values.state")
def a_pause_is_not_made(app: Any, patch: Patch) -> None:
    hear(app, patch, "/arm/task", without_task("pause"))


@defect("servicer", "arm", "/arm_command.velocity")
def jogging_goes_at_half_its_speed(app: Any, patch: Patch) -> None:
    swap(patch, app, "params", changed(app.params, "jog.speed", lambda limit: 0.5 * limit))


@defect("puma", "arm", "/arm_command.position")
def the_direction_of_the_tool_is_left_free(app: Any, patch: Patch) -> None:
    hear(app, patch, "/arm/goal_pose", lambda goal: goal._replace(orientation=np.zeros(4)))


@defect("puma", "arm", "/arm_command.position")
def corners_are_not_rounded(app: Any, patch: Patch) -> None:
    swap(patch, app, "params", changed(app.params, "tip_path.corner", lambda corner: 0.1 * corner))


@defect("puma", "arm", "/arm_command.velocity")
def a_timed_motion_takes_twice_as_long(app: Any, patch: Patch) -> None:
    def slower(motion: Any) -> Any:
        points = [point._replace(time_from_start=2 * point.time_from_start) for point in motion.points]
        return motion._replace(points=tuple(points))

    hear(app, patch, "/arm/joint_trajectory", slower)


@defect("servicer", "arm", "/arm_command.velocity")
def the_tip_is_jogged_the_other_way(app: Any, patch: Patch) -> None:
    hear(app, patch, "/arm/cmd_vel", lambda twist: twist._replace(linear=-twist.linear))


@defect("servicer", "arm", "/arm_command.position")
def the_base_is_thought_to_stand_still(app: Any, patch: Patch) -> None:
    attitude, first = app._afloat.attitude, []

    def still(*given: Any) -> Any:
        first.append(attitude(*given))
        return first[0]

    patch.setattr(app._afloat, "attitude", still)


@defect("arm_tasks", "arm", "/arm/status.status.values.contact_force_n")
def the_sensor_of_force_is_not_zeroed(app: Any, patch: Patch) -> None:
    hear(app, patch, "/arm/task", without_task("tare"))


@defect("arm_tasks", "arm", "/arm_command.position")
def a_touch_is_felt_at_twice_the_force(app: Any, patch: Patch) -> None:
    hear(app, patch, "/arm/task", lambda task: with_number(task, "force", lambda force: 2.0 * force))


@defect("arm_tasks", "arm", "/arm_command.position")
def the_wrench_is_never_heard(app: Any, patch: Patch) -> None:
    hear(app, patch, "/wrist/wrench", lambda wrench: None)


# Sensors


@defect(SHORT, "sensors", "/wrist/wrench.wrench.force.x")
def a_wrench_is_nan_once(app: Any, patch: Patch) -> None:
    def once(wrench: Any) -> Any:
        return wrench._replace(force=np.full(3, math.nan)) if wrench.stamp == 3 * SECOND else wrench

    say(app, patch, "/wrist/wrench", once)


# Power


@defect("solar", "power", "/battery_state.current")
def a_charging_current_is_taken_for_none(app: Any, patch: Patch) -> None:
    read = sojourn_power.app.battery_readings

    def drawn(bus: Any) -> Any:
        voltage, current, temperature = read(bus)
        return voltage, max(current, 0.0), temperature

    patch.setattr(sojourn_power.app, "battery_readings", drawn)


@defect("solar", "power", "/battery_state.percentage")
def charge_is_counted_at_half_the_current(app: Any, patch: Patch) -> None:
    read = sojourn_power.app.battery_readings

    def halved(bus: Any) -> Any:
        voltage, current, temperature = read(bus)
        return voltage, 0.5 * current, temperature

    patch.setattr(sojourn_power.app, "battery_readings", halved)


@defect("solar", "power", "/power/status.status.values.mode")
def a_wish_to_sleep_is_not_heard(app: Any, patch: Patch) -> None:
    hear(app, patch, "/power/request", lambda asked: None if "sleep" in status_values(asked) else asked)


@defect("solar", "power", "/power/switches.status.values.cameras")
def a_load_is_not_switched_off(app: Any, patch: Patch) -> None:
    hear(app, patch, "/power/request", lambda asked: None if status_values(asked) == {"cameras": "off"} else asked)


@defect("loose", "drive", "/drive/status.status.values.energy_used_wh")
def what_the_array_gives_does_not_count_as_taken(app: Any, patch: Patch) -> None:
    swap(patch, app._charge, "_costs", None)


@defect("low_charge", "power", "/power/status.status.values.request_state")
def a_request_is_lost(app: Any, patch: Patch) -> None:
    hear(app, patch, "/power/request", lambda asked: None)


@defect("low_charge", "power", "/power/status.status.values.shed")
def the_last_load_is_shed_too_early(app: Any, patch: Patch) -> None:
    swap(patch, app, "params", changed(app.params, "law.shed_soc_last", lambda limit: 0.2))


@defect("low_charge", "power", "/power/switches.status.values.actuator_heater")
def nothing_is_shed_for_want_of_charge(app: Any, patch: Patch) -> None:
    swap(patch, app, "params", changed(app.params, "law.shed_soc_first", lambda limit: 0.0))


@defect(SHORT, "power", "/power/switches.status.values.drive")
def the_drive_is_limited_at_another_voltage(app: Any, patch: Patch) -> None:
    swap(patch, app, "params", changed(app.params, "law.derate_start_voltage", lambda volts: volts - 0.3))
