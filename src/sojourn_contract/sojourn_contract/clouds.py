"""Clouds of points: numbers to messages and back. Those of contacts are in `messages.py`."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import FLOAT32, FLOAT64, PointCloud2, PointField

POINT_FIELDS = ("x", "y", "z")
"""Fields of /hazcam/points, all float32."""
ECHO_FIELDS = (*POINT_FIELDS, "intensity")
"""Fields of a lidar's cloud, all float32."""
_FIELDS = {
    len(names): tuple(PointField(name, 4 * place, FLOAT32) for place, name in enumerate(names))
    for names in (POINT_FIELDS, ECHO_FIELDS)
}
CODES = {FLOAT32: "f4", FLOAT64: "f8"}
"""Floating-point types of a PointField."""


def point_cloud(stamp: int, frame: str, points: NDArray[np.float32]) -> PointCloud2:
    """A cloud of points, shape (n, 3) [m] or with their intensity, (n, 4); n may be 0."""
    count, width = points.shape
    data, step = np.asarray(points, dtype=np.float32).tobytes(), 4 * width
    return PointCloud2(stamp, frame, count, _FIELDS[width], step, data, row_step=step * count)


def points_of(topic: str, cloud: PointCloud2) -> NDArray[np.float64]:
    """x, y, z of a cloud, shape (n, 3) [m]; further fields are not looked at.

    Raises:
        RefusedMessageError: a field that is missing or no single float, data of another length, a number that is not
            finite.
    """
    if not cloud.width * cloud.height:
        return np.zeros((0, 3))
    columns = finite_columns_of(topic, cloud, POINT_FIELDS)
    points = np.empty((cloud.width * cloud.height, len(POINT_FIELDS)))
    for place, name in enumerate(POINT_FIELDS):
        points[:, place] = columns[name]
    return points


def finite_columns_of(topic: str, cloud: PointCloud2, names: tuple[str, ...]) -> Mapping[str, NDArray[Any]]:
    """As `columns_of`. Raises RefusedMessageError for a number that is not finite, too."""
    columns = columns_of(topic, cloud, names)
    for name in names:
        finite = np.isfinite(columns[name])
        if not finite.all():
            point = int(np.argmin(finite))
            raise RefusedMessageError(topic, f"{name}[{point}]", float(columns[name][point]), "a finite number")
    return columns


def check_cloud(row: Topic, cloud: PointCloud2) -> None:
    """Raise RefusedMessageError for a cloud without the fields that its row names (x y z where it names none), or with
    a number in them that is not finite.
    """
    if cloud.width * cloud.height:
        named = tuple(name for rule in row.fields if not rule.optional for name in rule.path.split())
        finite_columns_of(row.name, cloud, named or POINT_FIELDS)


def columns_of(topic: str, cloud: PointCloud2, names: tuple[str, ...]) -> Mapping[str, NDArray[Any]]:
    """The named fields of a cloud as arrays, one number a point. Raises RefusedMessageError as `points_of`."""
    point = _point(topic, names, cloud.fields, cloud.point_step, bool(cloud.is_bigendian))
    count, data = cloud.width * cloud.height, cloud.data
    if len(data) != count * cloud.point_step:
        raise RefusedMessageError(topic, "data", f"{len(data)} bytes", f"{count} points of {cloud.point_step} bytes")
    points = np.frombuffer(data, dtype=point)
    return {name: points[name] for name in names}


@lru_cache(maxsize=64)  # a topic's clouds are alike, and numpy takes long over a type
def _point(
    topic: str, names: tuple[str, ...], fields: tuple[PointField, ...], step: int, is_bigendian: bool
) -> np.dtype[Any]:
    """The named fields of a point of so many bytes as a type of numpy. Raises RefusedMessageError."""
    known = {field.name: field for field in fields}
    for name in names:
        field = known.get(name)
        if field is None:
            raise RefusedMessageError(topic, "fields", " ".join(known), f"{' '.join(names)} among them")
        code = CODES.get(field.datatype)
        if code is None or field.elements != 1 or field.offset + int(code[1]) > step:
            raise RefusedMessageError(topic, f"fields.{name}", f"datatype {field.datatype}", "one float64 or float32")
    order = ">" if is_bigendian else "<"
    return np.dtype(
        {
            "names": list(names),
            "formats": [order + CODES[known[name].datatype] for name in names],
            "offsets": [known[name].offset for name in names],
            "itemsize": step,
        }
    )
