"""The workspace of an arm as a picture."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sojourn_analysis.arm.workspace import DIRECTIONS, WorkspaceMap, first_axis
from sojourn_flight.arm.closed_form import has_spherical_wrist, is_planar_with_yaw
from sojourn_flight.arm.redundancy import joint_origins
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.params import FloatArray

_BLANK = " "
_HARDLY = 0.01
"""Share of cells below which a map is not drawn."""
_FLAT = 0.08
"""Height over width below which a section is not drawn to scale."""
_INK, _ARM = "#333333", "#c1002d"


def draw_workspace(arm: SerialArm, found: WorkspaceMap, gravity: FloatArray, stance: FloatArray, path: Path) -> None:
    """Four maps of the section, the view along the first axis, and the figures of the layout, into a file.

    Args:
        stance: joint positions (n,) in which the arm is drawn.
    """
    figure = Figure(figsize=(13.0, 8.2), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 3)
    points = joint_origins(arm, stance)[1:]  # from the first joint on
    section = _to_section(arm, points) if found.about_axis else points[:, [0, 2]]
    payload = found.payload
    maps = (
        (
            found.pointing,
            f"{'Turns about the tool' if found.one_way else 'Pointing directions'} [share]",
            "viridis",
            1.0,
        ),
        (found.manipulability, "Manipulability", "cividis", None),
        (found.force, f"Force in the worst direction{', weightless' if found.weightless else ''} [N]", "magma", None),
        (payload, "Payload held at rest [kg]", "magma", None),
    )
    for axis, (values, title, colours, top) in zip(axes.flat[:4], maps, strict=True):
        if values is None:
            _say(axis, title, "no weight: any mass is held at rest")
            continue
        if not np.any(np.isfinite(values)):
            _say(axis, title, "without bound: no drive carries it")
            continue
        if np.nanmean(values > 0.0) < _HARDLY:
            _say(axis, title, "none: the arm cannot hold itself\nunder this gravity (see --gravity)")
            continue
        _map(figure, axis, found, values, title, colours, top)
        axis.plot(section[:, 0], section[:, 1], "-o", color=_ARM, linewidth=1.6, markersize=3, label="the arm")
    _view_along(axes.flat[4], arm, found, points)
    axes.flat[5].set_axis_off()
    axes.flat[5].text(0.0, 0.98, _layout(arm, found, gravity), va="top", fontsize=9.5, linespacing=1.55)
    figure.suptitle(f"Workspace of {arm.name} (red: the arm; collisions are not looked at)", fontsize=12)
    figure.savefig(path, dpi=110)


def _map(
    figure: Figure, axis: Axes, found: WorkspaceMap, values: FloatArray, title: str, colours: str, top: float | None
) -> None:
    values = np.where(np.isfinite(values), values, np.nan)
    finite = values[np.isfinite(values)]
    # a few postures near the axis give far more than all others: they would take the whole scale
    high = top if top is not None else float(np.percentile(finite, 98)) if finite.size else 1.0
    shown = axis.pcolormesh(found.across, found.height, values, cmap=colours, vmin=0.0, vmax=max(high, 1e-9))
    over = top is None and finite.size and float(finite.max()) > 1.02 * high
    beside = axis.inset_axes((1.03, 0.0, 0.05, 1.0))
    figure.colorbar(shown, cax=beside, extend="max" if over else "neither")
    across = "distance from the first joint's axis [m]" if found.about_axis else "x [m]"
    axis.set(title=title, xlabel=across, ylabel="height along it [m]" if found.about_axis else "z [m]")
    flat = np.ptp(found.height) < _FLAT * np.ptp(found.across)  # a planar arm: nothing to be seen to scale
    axis.set_aspect("auto" if flat else "equal")
    axis.set_facecolor("#f2f2f2")


def _view_along(axis: Axes, arm: SerialArm, found: WorkspaceMap, points: FloatArray) -> None:
    """Tips seen along the first axis, or from above."""
    first, second = _plane(arm)
    axis.plot(found.tips @ first, found.tips @ second, ",", color="#7aa6c2", alpha=0.5, rasterized=True)
    axis.plot(points @ first, points @ second, "-o", color=_ARM, linewidth=1.6, markersize=3)
    names = [_name(first), _name(second)]
    title = "Tips, seen along the first joint's axis" if found.about_axis else "Tips, seen from above"
    axis.set(title=title, xlabel=f"{names[0]} [m]", ylabel=f"{names[1]} [m]")
    axis.set_aspect("equal")


def _layout(arm: SerialArm, found: WorkspaceMap, gravity: FloatArray) -> str:
    kinds = "".join("R" if turns else "P" for turns in arm.revolute)
    wrist = (
        "spherical wrist"
        if has_spherical_wrist(arm)
        else "planar, with yaw and roll"
        if is_planar_with_yaw(arm)
        else ""
    )
    spare = arm.joint_count - 6
    freedom = "as many joints as a pose has numbers: 6"
    if spare:
        freedom = f"to spare for a pose: {spare}" if spare > 0 else f"missing for any pose: {-spare}"
    dexterous = float(np.mean(found.pointing[np.isfinite(found.pointing)] > 0.95))
    carried = None if found.payload is None else usual_payload(found.payload)
    lines = [
        f"joints: {arm.joint_count} ({kinds})" + (f", {wrist}" if wrist else ""),
        freedom,
        f"stretched length: {arm.reach:.3f} m",
        f"farthest tip from the axis: {found.reach_from_axis:.3f} m" if found.about_axis else "",
        f"volume reached: {found.volume:.4g} m³" if found.volume > 0.0 else "",
        f"gravity in the base: {gravity[0]:g} {gravity[1]:g} {gravity[2]:g} m/s²",
        f"the tool points one way; turns: of {DIRECTIONS} sectors"
        if found.one_way
        else f"pointing: of {DIRECTIONS} equal patches of the sphere; 1 is dexterous",
        f"dexterous (over 0.95): {100.0 * dexterous:.0f} % of the section",
        "" if carried is None else f"payload held in 95 % of the section: {carried:.3g} kg",
        "other maps: of the best posture found in each cell",
        _BLANK,
        "range of each joint, largest speed and effort:",
    ]
    for i, name in enumerate(arm.joint_names):
        turns = arm.revolute[i]
        low, high = np.degrees([arm.lower[i], arm.upper[i]]) if turns else (arm.lower[i], arm.upper[i])
        unit, rate, effort = ("°", "rad/s", "N m") if turns else (" m", "m/s", "N")
        speed, limit = arm.max_velocity[i], arm.max_effort[i]
        lines.append(f"  {name}: {low:.4g} to {high:.4g}{unit}, {speed:.3g} {rate}, {limit:.4g} {effort}")
    return "\n".join(line for line in lines if line)


def usual_payload(payload: FloatArray) -> float | None:
    """What is carried in 95 % of the cells of a map [kg]; None without bound."""
    known = payload[~np.isnan(payload)]
    value = float(np.quantile(known, 0.05, method="lower")) if known.size else 0.0
    return value if np.isfinite(value) else None


def _to_section(arm: SerialArm, points: FloatArray) -> FloatArray:
    """Points (k, 3) as distance from the first axis, signed by the side of the tip, and height (k, 2)."""
    place, axis = first_axis(arm)
    if axis[2] < -0.5:
        axis = -axis
    out = points - place
    height = out @ axis
    radial = out - height[:, None] * axis
    side = radial[-1] / max(float(np.linalg.norm(radial[-1])), 1e-9)
    sign = np.where(radial @ side < 0.0, -1.0, 1.0)
    return np.stack([sign * np.linalg.norm(radial, axis=1), height + float(place @ axis)], axis=1)


def _plane(arm: SerialArm) -> tuple[FloatArray, FloatArray]:
    """Two of the base's axes, square to the first joint's axis if that turns, else x and y."""
    axis = first_axis(arm)[1] if arm.revolute[0] else np.array([0.0, 0.0, 1.0])
    along = int(np.argmax(np.abs(axis)))
    first, second = (k for k in range(3) if k != along)
    return np.eye(3)[first], np.eye(3)[second]


def _name(axis: FloatArray) -> str:
    return "xyz"[int(np.argmax(axis))]


def _say(axis: Axes, title: str, words: str) -> None:
    axis.set_title(title)
    axis.set_axis_off()
    axis.text(0.5, 0.5, words, ha="center", va="center", color=_INK, transform=axis.transAxes)
