"""The map of a report: the track on the shaded ground, with rocks, goals and the places of the arm."""

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LightSource, ListedColormap
from matplotlib.figure import Figure

from sojourn_bags.goals import ARM_TOPICS, sent_goals
from sojourn_bags.machine import FloatArray, TrueMachine, poses_of
from sojourn_bags.reading import Bag
from sojourn_physics.terrain.height_field import HeightField

MARGIN_M = 2.0
"""Ground that is shown around the track."""
SMALLEST_M = 8.0
"""Smallest side of the map."""
MOST_NODES = 1200
"""Along a side; a finer ground is drawn coarser."""
LEAST_RUT_M = 0.002
"""Sinkage that is drawn as a rut."""
MOST_RUT_POINTS = 5000
"""Of one wheel; a longer run is drawn coarser."""
LIGHT = LightSource(azdeg=315.0, altdeg=40.0)
EXAGGERATION = 1.5
TRACK, BELIEF, GOAL, TARGET = "#0050b5", "#e66100", "#c1002d", "#8a00a8"
ROCK = ListedColormap(["#5a3a1c"])


def draw_map(figure: Figure, axes: Axes, bag: Bag, machine: TrueMachine, terrain: HeightField) -> None:
    """Draw the ground, the ruts, the true track, what the odometry made of it, and the places that the goals name."""
    path = poses_of(bag, "/truth/odom")
    drive_goals, arm_targets = _places(bag, machine)
    window = _window(np.vstack([path[:, :2], drive_goals, arm_targets]), terrain)
    _draw_ground(figure, axes, terrain, window)
    _draw_ruts(axes, bag)
    axes.plot(path[:, 0], path[:, 1], color="white", linewidth=4.5, alpha=0.7)
    axes.plot(path[:, 0], path[:, 1], color=TRACK, linewidth=2.0, label="true track")
    if "/odom" in bag:
        belief = poses_of(bag, "/odom")
        axes.plot(belief[:, 0], belief[:, 1], color=BELIEF, linewidth=1.4, linestyle=(0, (4, 3)), label="odometry")
    style: dict[str, Any] = {"linestyle": "", "markeredgecolor": "white", "markeredgewidth": 1.0}
    axes.plot(*path[0, :2], "o", color=TRACK, markersize=8, label="start", **style)
    if len(drive_goals):
        axes.plot(drive_goals[:, 0], drive_goals[:, 1], "X", color=GOAL, markersize=15, label="drive goal", **style)
    if len(arm_targets):
        axes.plot(
            arm_targets[:, 0],
            arm_targets[:, 1],
            "*",
            color=TARGET,
            markersize=15,
            label="arm target",
            **style,
        )
    axes.plot(*path[-1, :2], "s", color=TRACK, markersize=6, label="end", **style)
    axes.set(xlabel="x, east [m]", ylabel="y, north [m]", xlim=window[:2], ylim=window[2:])
    axes.set_title("Track on the terrain (brown: rocks, dark lines: ruts)")
    axes.set_aspect("equal")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.11), ncols=6, fontsize=8, frameon=False, columnspacing=1.2)


def _places(bag: Bag, machine: TrueMachine) -> tuple[FloatArray, FloatArray]:
    """Places in map that drive goals and arm goals name: shapes (n, 2). Unknown frames are left out."""
    places: dict[bool, list[FloatArray]] = {False: [], True: []}
    for goal in sent_goals(bag):
        if goal.target is None:
            continue
        try:
            point = machine.point_in_map(goal.frame, np.array(goal.target), goal.effect_s)
        except ValueError:
            continue
        places[goal.topic in ARM_TOPICS].append(point[:2])
    drive, arm = (np.array(places[kind]).reshape(-1, 2) for kind in (False, True))
    return drive, arm


def _window(points: FloatArray, terrain: HeightField) -> tuple[float, float, float, float]:
    """x_min, x_max, y_min, y_max to show: the points with a margin, inside the ground."""
    x_min, x_max, y_min, y_max = terrain.bounds
    sides: list[float] = []
    for values, low, high in ((points[:, 0], x_min, x_max), (points[:, 1], y_min, y_max)):
        middle = 0.5 * (values.min() + values.max())
        half = max(0.5 * (values.max() - values.min()) + MARGIN_M, 0.5 * SMALLEST_M)
        sides += [max(low, middle - half), min(high, middle + half)]
    return sides[0], sides[1], sides[2], sides[3]


def _draw_ground(figure: Figure, axes: Axes, terrain: HeightField, window: tuple[float, float, float, float]) -> None:
    """Heights as colours with the shade of a low sun, and rocks in brown."""
    resolution = terrain.resolution
    first_column, last_column = _span(window[0], window[1], terrain.origin_x, resolution, terrain.heights.shape[1])
    first_row, last_row = _span(window[2], window[3], terrain.origin_y, resolution, terrain.heights.shape[0])
    stride = max(1, math.ceil(max(last_column - first_column, last_row - first_row) / MOST_NODES))
    cut = (slice(first_row, last_row, stride), slice(first_column, last_column, stride))
    heights, soils = terrain.heights[cut], terrain.soil_index[cut]
    cell = resolution * stride
    x_start = terrain.origin_x + first_column * resolution - 0.5 * cell
    y_start = terrain.origin_y + first_row * resolution - 0.5 * cell
    extent = (x_start, x_start + heights.shape[1] * cell, y_start, y_start + heights.shape[0] * cell)
    # hillshade takes the first row for the northern one; here it is the southern one.
    shade = LIGHT.hillshade(heights, vert_exag=EXAGGERATION, dx=cell, dy=-cell)
    axes.imshow(shade, extent=extent, origin="lower", cmap="gray", vmin=0.0, vmax=1.0, interpolation="bilinear")
    colors = axes.imshow(heights, extent=extent, origin="lower", cmap="cividis", alpha=0.35, interpolation="bilinear")
    rocks = np.ma.masked_where(soils != 1, np.ones_like(soils))
    axes.imshow(rocks, extent=extent, origin="lower", cmap=ROCK, alpha=0.75, interpolation="nearest")
    figure.colorbar(colors, cax=axes.inset_axes((1.02, 0.0, 0.025, 1.0)), label="height [m]")


def _draw_ruts(axes: Axes, bag: Bag) -> None:
    """Where wheels have pressed the soil, as one dark line for each of them."""
    if "/truth/contacts" not in bag:
        return
    points = bag["/truth/contacts"].points()
    pressed = points["sinkage"] > LEAST_RUT_M
    x, y = (np.where(pressed, points[name], np.nan) for name in ("x", "y"))
    stride = max(1, len(x) // MOST_RUT_POINTS)
    axes.plot(x[::stride], y[::stride], color="#3a2a1a", linewidth=1.0, alpha=0.45)


def _span(low: float, high: float, origin: float, resolution: float, count: int) -> tuple[int, int]:
    """Nodes from `low` to `high`: the first, and the one after the last."""
    first = max(0, math.floor((low - origin) / resolution))
    return first, min(count, max(first + 2, math.ceil((high - origin) / resolution) + 1))
