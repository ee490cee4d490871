"""Sections about what the machine has inside: power with its loads, and the arm."""

from collections.abc import Iterator

import numpy as np

from sojourn_bags.curves import COLORS, FloatArray, short_name
from sojourn_bags.goals import ARM_TOPICS
from sojourn_bags.messages import JointHistory, Messages
from sojourn_bags.page.chart import ChartLine, Span, chart, strips, wheel_curves
from sojourn_bags.page.html import PageSection, figure, paragraph
from sojourn_bags.page.story import BATTERY, JOINTS, STATUS, Story
from sojourn_bags.page.wrist import wrist_figures
from sojourn_contract.switches import fraction_of

ON, PART, OFF = "#56b4e9", "#e69f00", "#333333"


def power(story: Story) -> PageSection:
    """Power, charge, bus and loads."""
    store, measured = story.find("/truth/electrical", BATTERY), story.find("/battery_state", BATTERY)
    source = store or measured
    parts = []
    if source is None:
        parts.append(
            paragraph("The bag has neither /truth/electrical nor /battery_state: power and charge are not known.")
        )
    else:
        parts += _battery(story, source, store, measured)
    parts += _told(story)
    parts.append(_switches(story))
    parts.append(_forecast(story))
    return PageSection("power", "Power and charge", "".join(parts))


def _battery(story: Story, source: Messages, store: Messages | None, measured: Messages | None) -> list[str]:
    times = story.times(source)
    drawn = ChartLine(times, -source.column("voltage") * source.column("current"), "out of the battery")
    charge = []
    for number, (messages, name) in enumerate(((store, "true"), (measured, "estimated"))):
        if messages is not None:
            values = 100.0 * messages.column("percentage")
            charge.append(ChartLine(story.times(messages), values, name, COLORS[number], number))
    volts = [ChartLine(times, source.column("voltage"), "at the battery" if store is None else "of the bus")]
    return [
        figure("Power out of the battery", chart(story.axis, [drawn], "power [W]", height=160.0)),
        figure("State of charge", chart(story.axis, charge, "charge [%]", height=140.0)),
        figure("Voltage", chart(story.axis, volts, "voltage [V]", height=130.0)),
    ]


def _told(story: Story) -> Iterator[str]:
    """What the plant tells of loads, sources and nodes, each by its name."""
    loads = story.find("/truth/loads", STATUS)
    if loads is None:
        return
    values = loads.statuses()
    for prefix, title, unit in (
        ("power ", "Power that each load draws", "power [W]"),
        ("source ", "Power that each source gives", "power [W]"),
        ("temperature ", "Temperatures of the machine", "temperature [K]"),
    ):
        names = list(dict.fromkeys(key for row in values for key in row if key.startswith(prefix)))
        told = np.array([[_number(row.get(name, "")) for name in names] for row in values])
        told = told.reshape(len(values), len(names))
        # what is 0 all the time would only fill the legend
        used = [column for column in range(len(names)) if np.nanmax(np.append(told[:, column], 0.0)) > 0.0]
        curves = wheel_curves(
            story.times(loads), told[:, used], [names[column].removeprefix(prefix) for column in used]
        )
        if curves:
            yield figure(title, chart(story.axis, curves, unit))


def _forecast(story: Story) -> str:
    """The words of the last forecast."""
    status = story.find("/power/status", STATUS)
    words = [row["forecast"] for row in status.statuses() if row.get("forecast")] if status else []
    return paragraph(f"Forecast at the end of the run: {words[-1]}.") if words else ""


def _switches(story: Story) -> str:
    messages = story.find("/power/switches", STATUS)
    if messages is None:
        return paragraph("How the loads were switched is not known: /power/switches is not in the bag.")
    times, values = story.times(messages), messages.statuses()
    names = list(dict.fromkeys(key for row in values for key in row if key not in ("name", "message")))
    rows = []
    for name in names:
        states = [row.get(name, "") for row in values]
        starts = [0, *(index for index in range(1, len(states)) if states[index] != states[index - 1])]
        ends = [*(times[index] for index in starts[1:]), story.axis.end]
        spans = [Span(float(times[index]), float(end), *_look(states[index]))
                 for index, end in zip(starts, ends, strict=True)]  # fmt: skip
        rows.append((name.replace("_", " "), spans))
    note = "Light blue: on; orange: with a part of its power; black: off."
    return figure("Switching of the loads", strips(story.axis, rows, "switching of the loads"), note)


def _look(text: str) -> tuple[str, str]:
    fraction = fraction_of(text)
    if fraction is None:
        return "#ffffff", f"{text!r} is no switch"
    if fraction == 1.0:
        return ON, "on"
    return (OFF, "off") if fraction == 0.0 else (PART, f"{100.0 * fraction:.0f} %")


def arm(story: Story) -> PageSection:
    """Joint angles as commanded and as they were, and the torques."""
    states, found = story.find("/truth/joint_states", JOINTS), story.true_joints
    source, name = (states, "true") if states else (story.find("/joint_states", JOINTS), "measured")
    joints = found if states else source.joints() if source else None
    names = list(story.run.arm_joints) if story.run else []
    if story.run and not names:
        return PageSection("arm", "Arm", paragraph("This rover has no arm."))
    if source is None or joints is None or not set(names) & set(joints.names):
        return PageSection(
            "arm", "Arm", paragraph("The bag tells of no arm: that takes the machine and its joint states.")
        )
    names = [joint for joint in names if joint in joints.names]
    goals = story.summary["goals"] if story.summary else []
    asked = any(goal["topic"] in ARM_TOPICS for goal in goals)
    times = story.times(source)
    if not asked and not any(np.ptp(joints.position[:, joints.index(joint)]) > 2e-3 for joint in names):
        torque = _largest(joints, names)
        text = f"The arm was not asked to move and has not moved. Largest torque that held it: {torque:.2f} N m."
        return PageSection("arm", "Arm", paragraph(text))
    command = story.find("/arm_command", JOINTS)
    wanted = command.joints() if command else None
    sliding = story.run.sliding_joints if story.run else frozenset()
    turning: list[ChartLine] = []
    travels: list[ChartLine] = []
    error_curves = []
    for number, joint in enumerate(names):
        color, place = COLORS[number % len(COLORS)], joints.index(joint)
        curves, scale = (travels, 1000.0) if joint in sliding else (turning, 180.0 / np.pi)
        curves.append(ChartLine(times, scale * joints.position[:, place], short_name(joint), color))
        if command is not None and wanted is not None and joint in wanted.names:
            target = scale * wanted.position[:, wanted.index(joint)]
            curves.append(ChartLine(story.times(command), target, f"{short_name(joint)}, commanded", color, 1))
            error_curves.append(_error(story, source, joints, command, wanted, joint, color))
    parts = [
        figure(f"{what}, {name} and commanded", chart(story.axis, curves, unit, height=240.0))
        for what, curves, unit in (
            ("Joint angles", turning, "angle [degree]"), ("Joints that slide", travels, "position [mm]")
        )
        if curves
    ]  # fmt: skip
    if error_curves:
        title = f"Commanded less {name} angle, at the same stamp"
        unit = "error [mrad], [mm]" if travels else "error [mrad]"
        parts.append(figure(title, chart(story.axis, error_curves, unit)))
    efforts = joints.effort[:, [joints.index(joint) for joint in names]]
    if np.isfinite(efforts).any():
        curves = wheel_curves(times, efforts, [short_name(joint) for joint in names])
        unit = "torque [N m], force [N]" if travels else "torque [N m]"
        parts.append(figure("Torque of the arm joints", chart(story.axis, curves, unit)))
    parts += wrist_figures(story)
    return PageSection("arm", "Arm", "".join(parts))


def _error(
    story: Story,
    source: Messages,
    joints: JointHistory,
    command: Messages,
    wanted: JointHistory,
    joint: str,
    color: str,
) -> ChartLine:
    _, rows, others = np.intersect1d(source.times, command.times, return_indices=True)
    difference = wanted.position[others, wanted.index(joint)] - joints.position[rows, joints.index(joint)]
    return ChartLine(story.times(source)[rows], 1000.0 * difference, short_name(joint), color)


def _largest(joints: JointHistory, names: list[str]) -> float:
    efforts: FloatArray = np.abs(joints.effort[:, [joints.index(name) for name in names]])
    return float(np.nanmax(efforts)) if np.isfinite(efforts).any() else float("nan")


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")
