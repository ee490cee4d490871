"""The picture of a run, report.png: track on the terrain, sinkage and slip, torques, power and charge."""

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sojourn_bags.curves import COLORS, means, short_name, thinned
from sojourn_bags.description import Run
from sojourn_bags.goals import ARM_TOPICS
from sojourn_bags.machine import FloatArray, TrueMachine, euler_angles, poses_of
from sojourn_bags.messages import Messages
from sojourn_bags.reading import Bag
from sojourn_bags.report_afloat import draw_base
from sojourn_bags.report_arm import draw_standing_arm
from sojourn_bags.report_map import draw_map
from sojourn_bags.summary import summarise
from sojourn_bags.true_slip import WHERE_IT_STANDS, true_slip
from sojourn_physics.terrain.height_field import HeightField

SIZE_INCHES = (17.0, 12.0)
DOTS_PER_INCH = 110
DRIVE_SHADE, ARM_SHADE = "#0072b2", "#8a00a8"
TIME_LABEL = "simulation time [s]      blue: drive goal, violet: arm goal; faint: each value, bold: mean"
LEGEND_ROOM = 0.2
"""Over curves whose legend has no place beside them, of their height [-]."""
NEEDED = ("/truth/odom", "/truth/joint_states", "/truth/contacts", "/truth/electrical")


def write_report(
    bag: Bag,
    path: Path,
    run: Run | None = None,
    summary: dict[str, Any] | None = None,
    terrain: HeightField | None = None,
) -> None:
    """Draw the report of a bag into a PNG file.

    Args:
        bag: the run's bag. path: file to write.
        run: description of its scenario, None for the one in the bag.
        summary: as `summarise` gives it, None to make it here. terrain: the ground, None to make it again.

    Raises:
        UnknownTopicInBagError: the bag lacks the truth of the plant.
        IncompleteConfigError: it does not say what was run.
    """
    for topic in NEEDED:
        bag[topic]  # says which topic is missing
    run = run or Run.of_bag(bag)
    summary = summary or summarise(bag, run)
    figure = Figure(figsize=SIZE_INCHES, dpi=DOTS_PER_INCH, layout="constrained")
    FigureCanvasAgg(figure)
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.06)  # type: ignore[union-attr, call-arg]
    figure.suptitle(_title(summary), fontsize=13, x=0.01, ha="left")
    grid = figure.add_gridspec(4, 2, width_ratios=(1.12, 1.0))
    where, machine = figure.add_subplot(grid[0:2, 0]), TrueMachine(bag, run.urdf)
    if run.machine.floats:
        draw_base(where, bag, machine)
    else:
        draw_map(figure, where, bag, machine, terrain or run.terrain())

    charge_axes = figure.add_subplot(grid[2, 0])
    arm_axes = figure.add_subplot(grid[3, 0], sharex=charge_axes)
    wheel_axes = [figure.add_subplot(grid[row, 1], sharex=charge_axes) for row in range(4)]
    _draw_power(charge_axes, bag)
    if run.arm_joints:
        label = "torque [N m]" if run.machine.stands_on else "torque [N m], force [N]"
        _draw_joints(arm_axes, bag, run.arm_joints, "Torque of the arm joints, force at the wrist", label)
        _draw_wrist(arm_axes, bag)
    else:
        _draw_attitude(arm_axes, bag)
    if run.machine.stands_on:
        _draw_wheels(wheel_axes, bag, run)
    else:
        draw_standing_arm(wheel_axes, bag, run.machine, run.arm_joints, _draw_curves)
    times = (charge_axes, arm_axes, *wheel_axes)
    for axes in times:
        _shade_goals(axes, summary["goals"])
        axes.grid(alpha=0.25)
        axes.set_xlim(0.0, max(summary["sim_time_s"], 1e-3))
    for axes in (arm_axes, wheel_axes[3]):
        axes.set_xlabel(TIME_LABEL)
    try:
        figure.savefig(path)
    finally:
        figure.clear()


def _title(summary: dict[str, Any]) -> str:
    """Scenario, numbers and verdict."""
    numbers = [f"seed {summary['seed']}", f"{summary['sim_time_s']:.0f} s simulated"]
    for key, text in (
        ("distance_m", "{:.1f} m driven"),
        ("energy_wh", "{:.1f} Wh used"),
        ("max_sinkage_m", "largest sinkage {:.3f} m"),
        ("max_tilt_deg", "largest tilt {:.1f}°"),
    ):
        if summary[key] is not None:
            numbers.append(text.format(summary[key]))
    verdict = textwrap.fill(summary["verdict"], 160)
    return f"{summary['scenario']}  ({', '.join(numbers)})\n{verdict}"


def _draw_wheels(panels: Sequence[Axes], bag: Bag, run: Run) -> None:
    """Four panels of a machine with wheels or tracks."""
    each = f"each {run.machine.support_word}"
    _draw_contacts(panels[0], bag, run, "sinkage", 1000.0, f"Sinkage of {each}", "sinkage [mm]")
    _draw_slip(panels[1], bag, run)
    _draw_joints(panels[2], bag, [wheel.joint for wheel in run.machine.rolling], "Torque of the drives")
    if run.machine.steer_joints:
        _draw_joints(panels[3], bag, list(run.machine.steer_joints), "Torque of the steering joints")
    else:
        names = [wheel.name.replace("_", " ") for wheel in run.machine.rolling]
        _draw_curves(panels[3], bag["/truth/contacts"].times, np.degrees(true_slip(bag, run, "slip_angle")), names)
        panels[3].set(title=f"Slip angle of {each} ({WHERE_IT_STANDS})", ylabel="angle [°]")


def _draw_contacts(axes: Axes, bag: Bag, run: Run, field: str, scale: float, title: str, label: str) -> None:
    """One curve a support from the true contacts, whose first points are those that the machine stands on."""
    contacts = bag["/truth/contacts"]
    values = scale * contacts.points()[field]
    names = [support.name.replace("_", " ") for support in run.machine.stands_on]
    _draw_curves(axes, contacts.times, values[:, : len(names)], names)
    axes.set(title=title, ylabel=label)


def _draw_slip(axes: Axes, bag: Bag, run: Run) -> None:
    """One curve a wheel or track."""
    names = [wheel.name.replace("_", " ") for wheel in run.machine.rolling]
    _draw_curves(axes, bag["/truth/contacts"].times, true_slip(bag, run, "slip_ratio"), names)
    axes.set(title=f"Slip of each {run.machine.support_word} ({WHERE_IT_STANDS})", ylabel="slip ratio [-]")


def _draw_joints(axes: Axes, bag: Bag, names: Sequence[str], title: str, label: str = "torque [N m]") -> None:
    """One curve a joint from the true efforts."""
    states: Messages = bag["/truth/joint_states"]
    joints = states.joints()
    known = [name for name in names if name in joints.names]
    values = joints.effort[:, [joints.index(name) for name in known]]
    _draw_curves(axes, states.times, values, [short_name(name) for name in known])
    axes.set(title=title, ylabel=label)


def _draw_wrist(axes: Axes, bag: Bag) -> None:
    """Size of the force at the wrist on an axis of its own, where it was measured."""
    if "/wrist/wrench" not in bag:
        return
    wrench = bag["/wrist/wrench"]
    force = np.linalg.norm(wrench.columns(*(f"wrench.force.{axis}" for axis in "xyz")), axis=1)
    if not np.isfinite(force).any():
        return
    scale = axes.twinx()
    scale.plot(*thinned(wrench.times, force), color="black", linewidth=0.9, alpha=0.6, label="wrist")
    scale.set_ylabel("force at the wrist [N], black")
    scale.set_ylim(bottom=0.0)
    if axes.lines:
        for each in (axes, scale):  # room for the legend over the curves: the other axis has the place beside them
            low, high = each.get_ylim()
            each.set_ylim(low, high + LEGEND_ROOM * (high - low))
        axes.legend(fontsize=7, loc="upper left", ncols=5, frameon=False)


def _draw_attitude(axes: Axes, bag: Bag) -> None:
    """Roll and pitch of the chassis, from its true attitude."""
    angles = np.degrees(euler_angles(poses_of(bag, "/truth/odom")[:, 3:]))
    _draw_curves(axes, bag["/truth/odom"].times, angles[:, :2], ["roll, left up", "pitch, nose down"])
    axes.set(title="Roll and pitch of the chassis", ylabel="angle [°]")


def _draw_power(axes: Axes, bag: Bag) -> None:
    """Power out of the battery and its charge."""
    store = bag["/truth/electrical"]
    power = -store.column("voltage") * store.column("current")
    _draw_curves(axes, store.times, power[:, np.newaxis], ["power out of the battery"])
    axes.set(title="Power and charge", ylabel="power [W]")
    axes.set_ylim(bottom=min(0.0, 1.1 * float(np.nanmin(power))), top=max(1.0, 1.15 * float(np.nanmax(power))))
    charge = axes.twinx()
    percent = 100.0 * store.column("percentage")
    charge.plot(store.times, percent, color=COLORS[1], linewidth=1.6, label="charge")
    middle, half = 0.5 * (percent.min() + percent.max()), max(1.0, 0.6 * float(np.ptp(percent)))
    charge.set_ylim(middle - half, middle + half)
    charge.set_ylabel("charge [%]", color=COLORS[1])
    axes.yaxis.label.set_color(COLORS[0])
    lines = [axes.get_lines()[-1], *charge.get_lines()]
    axes.legend(lines, [str(line.get_label()) for line in lines], fontsize=8, loc="upper right", framealpha=0.85)


def _draw_curves(axes: Axes, times: FloatArray, values: FloatArray, names: Sequence[str]) -> None:
    """Curves with a legend beside them: every value faintly (thinned, but with its peaks), and the mean."""
    for number, name in enumerate(names):
        color = COLORS[number % len(COLORS)]
        axes.plot(*thinned(times, values[:, number]), color=color, linewidth=0.6, alpha=0.25)
        axes.plot(*means(times, values[:, number]), color=color, linewidth=1.3, label=name)
    if len(names) > 1:
        axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, handlelength=1.2)


def _shade_goals(axes: Axes, goals: Sequence[dict[str, Any]]) -> None:
    """Mark when a goal was under way."""
    for goal in goals:
        color = ARM_SHADE if goal["topic"] in ARM_TOPICS else DRIVE_SHADE
        axes.axvspan(goal["start_s"], goal["end_s"], color=color, alpha=0.07, linewidth=0.0)
