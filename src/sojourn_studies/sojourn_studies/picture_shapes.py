"""Shapes of a machine, from the primitives of its URDF, as outlines in a plane."""

from typing import Any

import numpy as np
import pinocchio as pin
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from scipy.spatial import ConvexHull

from sojourn_config.scenario import LoadedScenario
from sojourn_machine.supports import TrackParams
from sojourn_studies.picture_style import GREY


def placed_shapes(scenario: LoadedScenario, pose: str) -> tuple[pin.Model, pin.GeometryModel, tuple]:
    """Model, visual shapes, and (its data, outline points of each shape) with the arm in a named pose."""
    model = pin.buildModelFromXML(scenario.urdf_xml)
    geometry = pin.buildGeomFromUrdfString(model, scenario.urdf_xml, pin.GeometryType.VISUAL)
    arm, angles = scenario.carried_arm(), pin.neutral(model)
    for name, value in zip(arm.joint_names, arm.named_poses[pose], strict=True):
        angles[model.joints[model.getJointId(name)].idx_q] = value
    data, places = model.createData(), geometry.createData()
    pin.forwardKinematics(model, data, angles)
    pin.updateFramePlacements(model, data)
    pin.updateGeometryPlacements(model, data, geometry, places)
    outlines = []
    for shape, place in zip(geometry.geometryObjects, places.oMg, strict=True):
        local = outline(shape.geometry)
        outlines.append((local @ place.rotation.T + place.translation, shape.meshColor, shape.name))
    return model, geometry, (data, outlines)


def placed_joint(model: pin.Model, placed: tuple, joint: str) -> np.ndarray:
    """Place of a joint in base_link, shape (3,) [m]."""
    return placed[0].oMi[model.getJointId(joint)].translation


def outline(shape: Any) -> np.ndarray:
    """Points whose convex hull is the shape, (n, 3)."""
    kind = type(shape).__name__
    if kind == "Box":
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
        return signs * np.array(shape.halfSide)
    turn = np.linspace(0.0, 2.0 * np.pi, 49)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1) * shape.radius
    if kind == "Cylinder":
        half = shape.halfLength
        return np.vstack([np.column_stack([circle, np.full(len(turn), z)]) for z in (-half, half)])
    rings = np.linspace(-np.pi / 2, np.pi / 2, 13)
    return np.vstack(
        [np.column_stack([circle * np.cos(a), np.full(len(turn), shape.radius * np.sin(a))]) for a in rings]
    )


def track_shapes(track: TrackParams) -> list[tuple[np.ndarray, np.ndarray]]:
    """A track as its plates lie, and its road wheels before it: points whose convex hull each is, in the frame of its
    link (n, 3), and its colour.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, 49)
    circle = np.column_stack([np.cos(turn), np.zeros(len(turn)), np.sin(turn)])
    belt = [np.array([[end * track.length, 0.0, 0.0] for end in (0.5, -0.5)])]
    for sense, end in ((1.0, track.front), (-1.0, track.rear)):
        angle = np.radians(end.angle_deg)
        ahead = 0.5 * track.length + end.length * np.cos(angle) - end.radius * np.sin(angle)
        up = end.length * np.sin(angle) + end.radius * np.cos(angle)
        belt.append(end.radius * circle + np.array([sense * ahead, 0.0, up]))
    points = np.vstack(belt)
    size = 0.4 * min(track.length / track.road_wheels, points[:, 2].max())
    shapes = [(points, np.array([0.2, 0.2, 0.2, 1.0]))]
    for part in (np.arange(track.road_wheels) + 0.5) / track.road_wheels - 0.5:
        wheel = size * circle + np.array([part * track.length, 0.0, 1.2 * size])
        shapes.append((wheel, np.array([0.45, 0.45, 0.48, 1.0])))
    outside = [np.array([0.0, side * 0.5 * track.width, 0.0]) for side in (1.0, -1.0)]
    return [
        (np.vstack([points + edge for edge in outside]) + np.array(track.position), color) for points, color in shapes
    ]


def draw_shapes(axis: Axes, geometry: pin.GeometryModel, placed: tuple, plane: tuple[int, int]) -> None:
    """Shapes as filled outlines, the near ones over the far ones. The side view is seen from the right (from -y)."""
    depth = 1 if plane == (0, 2) else 2
    nearer = -1.0 if depth == 1 else 1.0
    for points, color, _ in placed[1]:
        flat = points[:, plane]
        corners = flat[ConvexHull(flat).vertices]
        order = (nearer * points[:, depth]).max()
        axis.add_patch(
            Polygon(
                corners,
                facecolor=np.clip(color[:3], 0, 1),
                edgecolor="#1c1c1c",
                linewidth=0.6,
                zorder=100 + 100 * order,
            )
        )


def dimension(axis: Axes, start: tuple[float, float], end: tuple[float, float], text: str) -> None:
    """A dimension line with its text in the middle."""
    arrow = {"arrowstyle": "<|-|>", "color": GREY, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0}
    axis.annotate("", end, start, arrowprops=arrow, zorder=900)
    upright = abs(end[0] - start[0]) < abs(end[1] - start[1])
    axis.text(
        (start[0] + end[0]) / 2,
        (start[1] + end[1]) / 2,
        text,
        rotation=90 if upright else 0,
        ha="center",
        va="center",
        fontsize=8.5,
        zorder=901,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
    )
