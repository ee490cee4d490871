"""Pictures of the manuals: machines, where an arm reaches, how wheels steer, a course driven."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pinocchio as pin
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from sojourn_bags.description import Run
from sojourn_bags.machine import poses_of
from sojourn_bags.reading import read_bag
from sojourn_config.paths import repository_root
from sojourn_config.scenario import LoadedScenario
from sojourn_flight.arm.collision import check_posture
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.kinematics import inverse_kinematics
from sojourn_flight.arm.model import ArmModel, build_arm_model
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.mobility.kinematics import wheels_from_twist
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_machine.supports import TrackParams
from sojourn_studies.picture_shapes import (
    dimension,
    draw_shapes,
    outline,
    placed_joint,
    placed_shapes,
    track_shapes,
)
from sojourn_studies.picture_style import BLUE, GREY, ORANGE, PINK

GROUND_IN_BASE = -0.47
"""Height of flat, hard ground in base_link [m]: chassis floor 0.30 m above it (see urdf/explorer.urdf)."""


def explorer(scenario: LoadedScenario) -> Figure:
    """The machine in side and top view, from the primitives of its URDF."""
    model, geometry, placed = placed_shapes(scenario, "unfold")
    figure, axes = plt.subplots(
        1, 2, figsize=(11.0, 4.6), layout="constrained", gridspec_kw={"width_ratios": [2.25, 1.7]}
    )
    for axis, plane in zip(axes, ((0, 2), (0, 1)), strict=True):
        draw_shapes(axis, geometry, placed, plane)
        axis.set_aspect("equal")
        axis.grid(True, alpha=0.25)
        axis.set_axisbelow(True)
    side, top = axes
    side.axhspan(-0.62, GROUND_IN_BASE, color="#d9d4ca", zorder=0)
    side.set(
        xlim=(-1.05, 1.75),
        ylim=(-0.62, 1.2),
        xlabel="x forward [m]",
        ylabel="z up [m]",
        title="From the right",
    )
    top.set(
        xlim=(-1.15, 1.65),
        ylim=(-0.95, 0.95),
        xlabel="x forward [m]",
        ylabel="y left [m]",
        title="From above",
    )
    wheels = {wheel.name: placed_joint(model, placed, wheel.joint) for wheel in scenario.machine.wheels}
    front, rear = wheels["front_right"], wheels["rear_right"]
    dimension(side, (rear[0], -0.54), (front[0], -0.54), f"wheelbase {front[0] - rear[0]:.2f} m")
    left, right = wheels["rear_left"], wheels["rear_right"]
    dimension(top, (-1.02, right[1]), (-1.02, left[1]), f"track {left[1] - right[1]:.2f} m")
    head = max(points[:, 2].max() for points, *_ in placed[1])
    dimension(side, (-0.95, GROUND_IN_BASE), (-0.95, head), f"{head - GROUND_IN_BASE:.2f} m")
    tip = placed[0].oMf[model.getFrameId("arm_tip_link")].translation
    for axis, point in ((side, (tip[0], tip[2])), (top, (tip[0], tip[1]))):
        axis.plot(*point, "o", color="#c1002d", markersize=4, zorder=1000)
    side.annotate("arm_tip_link", (tip[0], tip[2]), (tip[0] + 0.08, tip[2] + 0.09), fontsize=8.5, color="#c1002d")
    side.plot(0, 0, "+", color="#c1002d", markersize=11, zorder=1000)
    side.annotate("base_link", (0, 0), (0.04, 0.05), fontsize=8.5, color="#c1002d", zorder=1000)
    mass = sum(inertia.mass for inertia in model.inertias)
    figure.suptitle(f"urdf/explorer.urdf: {mass:.0f} kg, arm unfolded", fontsize=10.5)
    return figure


def arm(scenario: LoadedScenario) -> Figure:
    """Where the tip can go: a section ahead of the rover, and the ground, without and with the tool pointing down."""
    params = scenario.carried_arm()
    model = build_arm_model(scenario.urdf_xml, params)
    machine, geometry, placed = placed_shapes(scenario, "stow")
    shoulder = placed_joint(machine, placed, params.joint_names[0])[1]
    cell = 0.04
    x, y, z = np.arange(0.2, 1.7, cell), np.arange(-1.1, 0.9, cell), np.arange(-0.6, 1.0, cell)
    section = np.array([[reach_class(params, model, (u, shoulder, w)) for u in x] for w in z])
    ground = np.array([[reach_class(params, model, (u, v, GROUND_IN_BASE)) for u in x] for v in y])
    figure, axes = plt.subplots(1, 2, figsize=(9.6, 4.7), layout="constrained")
    shades = ListedColormap(["#ffffff", "#9ecae1", "#2171b5"])
    norm = BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3)
    for axis, values, side, plane in ((axes[0], section, z, (0, 2)), (axes[1], ground, y, (0, 1))):
        extent = (x[0] - cell / 2, x[-1] + cell / 2, side[0] - cell / 2, side[-1] + cell / 2)
        axis.imshow(values, extent=extent, origin="lower", cmap=shades, norm=norm, zorder=1)
        draw_shapes(axis, geometry, placed, plane)
        axis.set_aspect("equal")
        axis.set(xlim=(-0.1, extent[1]), ylim=extent[2:])
    axes[0].axhline(GROUND_IN_BASE, color="#8c6d46", linewidth=2.0, zorder=900)
    axes[0].text(-0.07, GROUND_IN_BASE - 0.02, "flat ground", color="#8c6d46", va="top", fontsize=8.5, zorder=900)
    axes[0].set(
        xlabel="x in base_link [m]",
        ylabel="z in base_link [m]",
        title=f"Section through the shoulder, y = {shoulder:.2f} m",
    )
    axes[1].set(
        xlabel="x in base_link [m]",
        ylabel="y in base_link [m]",
        title=f"On flat ground, z = {GROUND_IN_BASE} m",
    )
    names = (
        "out of reach, or in collision",
        "some direction of the tool",
        "also with the tool straight down",
    )
    handles = [Rectangle((0, 0), 1, 1, facecolor=shades(i), edgecolor=GREY, linewidth=0.5) for i in range(3)]
    figure.legend(handles, names, loc="outside lower center", ncols=3, frameon=False)
    figure.suptitle("Where the tip of the explorer's arm can be, free of collisions (arm drawn stowed)", fontsize=10.5)
    return figure


def reach_class(params: ArmParams, model: ArmModel, target: tuple[float, float, float]) -> int:
    """2 if the arm can be at a place [m] with the tool down, 1 if with some direction, 0 if not; free of collisions."""
    position, start = np.array(target), np.array(params.named_poses["unfold"])
    ground = GroundPlane(GROUND_IN_BASE)
    for found, direction in ((2, np.array([0.0, 0.0, -1.0])), (1, None)):
        answer = inverse_kinematics(params, model, position, direction, start, explain=False)
        if any(check_posture(params, model, posture, ground) is None for posture in answer.solutions):
            return found
    return 0


def steering(scenario: LoadedScenario) -> Figure:
    """Wheels of the explorer in a curve, sideways and in a point turn, from the steering kinematics."""
    geometry = scenario.steering
    table, size = geometry.table(), scenario.machine.wheels[0]
    motions = (
        ("Curve of 1.5 m radius", PlanarTwist(0.05, 0.0, 0.05 / 1.5)),
        ("Diagonal, heading kept", PlanarTwist(0.05, 0.05, 0.0)),
        ("Point turn", PlanarTwist(0.0, 0.0, 0.1)),
    )
    figure, axes = plt.subplots(1, 3, figsize=(11.0, 4.7))
    figure.subplots_adjust(left=0.06, right=0.99, bottom=0.1, top=0.87, wspace=0.15)
    for axis, (title, twist) in zip(axes, motions, strict=True):
        setpoints = wheels_from_twist(table, twist, np.zeros(len(table)))
        axis.add_patch(Rectangle((-0.45, -0.27), 0.9, 0.54, facecolor="#dedbd2", edgecolor=GREY))
        if twist.yaw_rate:
            centre = (-twist.v_y / twist.yaw_rate, twist.v_x / twist.yaw_rate)
            axis.plot(*centre, "o", color=ORANGE, markersize=6, zorder=20)
        for wheel, angle, rate, miss in zip(
            geometry.wheels, setpoints.steer_angles, setpoints.wheel_rates, setpoints.residual, strict=True
        ):
            heading = np.array([np.cos(angle), np.sin(angle)])
            across, place = np.array([-heading[1], heading[0]]), np.array([wheel.x, wheel.y])
            corners = [
                place + a * size.radius * heading + b * size.width / 2 * across
                for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))
            ]
            axis.add_patch(Polygon(corners, facecolor="#404040" if abs(miss) < 1e-6 else PINK, zorder=10))
            tip = place + heading * 4.0 * rate * wheel.radius
            arrow = {"arrowstyle": "-|>", "color": BLUE, "linewidth": 1.8, "shrinkA": 0, "shrinkB": 0}
            axis.annotate("", tip, place, arrowprops=arrow, zorder=30)
            if twist.yaw_rate:
                axis.plot(*np.array([place, centre]).T, color=ORANGE, linewidth=0.7, linestyle=":", zorder=5)
        axis.set_aspect("equal")
        axis.set(xlim=(-1.1, 1.25), ylim=(-0.9, 1.75), title=title, xlabel="x forward [m]")
    axes[0].set_ylabel("y left [m]")
    figure.suptitle(
        "Blue: velocity at the rim; orange: centre of rotation; pink: a fixed wheel that has to scrub",
        fontsize=10,
    )
    return figure


def _with_tracks(shapes: list[tuple], tracks: Sequence[TrackParams], model: pin.Model, data: pin.Data) -> list[tuple]:
    """The shapes with the tracks as they meet the ground, in place of their frames and sprockets."""
    links = {track.link for track in tracks}
    links |= {frame.name for frame in model.frames for track in tracks if _turns(model, frame, track)}
    kept = [shape for shape in shapes if shape[2].rsplit("_", 1)[0] not in links]
    for track in tracks:
        frame = model.frames[model.getFrameId(track.link)]
        place = data.oMi[frame.parentJoint].act(frame.placement)
        for points, color in track_shapes(track):
            kept.append((points @ place.rotation.T + place.translation, color, track.name))
    return kept


def _turns(model: pin.Model, frame: pin.Frame, track: TrackParams) -> bool:
    return frame.type == pin.FrameType.BODY and frame.parentJoint == model.getJointId(track.joint)


def course(run: Path, name: str = "") -> None:
    """A machine from the right, and its track over the heights of its course, from a run of the demo with --machine.

    Args:
        name: of the machine and of the picture; left out: as config/machines has it.
    """
    bag = read_bag(run)
    story = Run.of_bag(bag)
    model = pin.buildModelFromXML(story.urdf)
    geometry = pin.buildGeomFromUrdfString(model, story.urdf, pin.GeometryType.VISUAL)
    data, places = model.createData(), geometry.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    pin.updateGeometryPlacements(model, data, geometry, places)
    shapes = [
        (outline(shape.geometry) @ place.rotation.T + place.translation, shape.meshColor, shape.name)
        for shape, place in zip(geometry.geometryObjects, places.oMg, strict=True)
    ]
    shapes = _with_tracks(shapes, story.machine.tracks, model, data)
    figure, (side, above) = plt.subplots(
        1, 2, figsize=(10.0, 3.6), layout="constrained", gridspec_kw={"width_ratios": [1.0, 1.25]}
    )
    draw_shapes(side, geometry, (data, shapes), (0, 2))
    points = np.vstack([shape for shape, *_ in shapes])
    ground = points[:, 2].min()
    side.axhline(ground, color="#8c6d46", linewidth=2.0)
    side.set_aspect("equal")
    reach = 0.1 * np.ptp(points[:, 0])
    ends = points[:, 0].min() - reach, points[:, 0].max() + reach
    side.set(xlim=ends, ylim=(ground - reach, points[:, 2].max() + reach),
             xlabel="x forward [m]", ylabel="z up [m]", title="From the right")  # fmt: skip
    terrain, way = story.terrain(), poses_of(bag, "/truth/odom")
    x_min, x_max, y_min, y_max = terrain.bounds
    low, high = way[:, :2].min(axis=0) - 1.0, way[:, :2].max(axis=0) + 1.0
    beside = max(0.5 * (0.45 * (high[0] - low[0]) - (high[1] - low[1])), 0.0)  # of a long way more than a strip
    x = np.linspace(max(low[0], x_min), min(high[0], x_max), 160)
    y = np.linspace(max(low[1] - beside, y_min), min(high[1] + beside, y_max), 120)
    heights = np.array([[terrain.height(float(u), float(v)) for u in x] for v in y])
    shade = above.pcolormesh(x, y, heights, cmap="cividis", shading="auto", rasterized=True)
    figure.colorbar(shade, cax=above.inset_axes((1.02, 0.0, 0.025, 1.0)), label="height [m]")
    above.plot(way[:, 0], way[:, 1], color="white", linewidth=2.2)
    above.plot(way[:, 0], way[:, 1], color=ORANGE, linewidth=1.2)
    above.plot(*way[0, :2], "o", color="white", markersize=5)
    above.plot(*way[-1, :2], "s", color="white", markersize=5)
    above.set_aspect("equal")
    above.set(xlabel="x, east [m]", ylabel="y, north [m]", title="Its course: from the circle to the square mark")
    name = name or story.scenario.machine
    figure.suptitle(f"{name}: {story.machine.description}", fontsize=10.5)
    target = repository_root() / "src" / "sojourn_machine" / "doc" / f"{name}.jpg"
    figure.savefig(target, dpi=90, pil_kwargs={"quality": 80, "optimize": True})
    plt.close(figure)
    print(f"{target.relative_to(repository_root())}: {target.stat().st_size // 1024} kB")
