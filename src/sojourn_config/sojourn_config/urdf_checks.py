"""What no machine can have, in the elements of a URDF: limits the wrong way round, sizes that are no sizes, meshes that
are not there, and xacro, a language of its own that has to be made into a URDF first.
"""

import math
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote, urlparse
from xml.etree import ElementTree

from sojourn_config.errors import Problem

MOST_BYTES = 10_000_000
"""Of a file."""
SIZES = {"cylinder": ("radius", "length"), "sphere": ("radius",), "box": ("size",)}


def element_problems(root: ElementTree.Element, file: str, folder: Path | None) -> Iterator[Problem]:
    """All that is wrong with the elements by themselves.

    Args:
        root: element robot. file: its name, for messages. folder: where it lies; None where nobody knows, and meshes
            cannot be looked for.
    """
    for element in root.iter():
        if isinstance(element.tag, str) and "xacro" in element.tag:
            name = element.tag.partition("}")[2] or element.tag
            allowed = "is xacro, which is not carried out here: allowed is the URDF that xacro makes of the file"
            yield Problem(file, f"xacro:{name}", "", allowed)
            return
    for joint in root.findall("joint"):
        yield from _limit_problems(joint, file)
    for link in root.findall("link"):
        yield from _shape_problems(link, file, folder)


def _limit_problems(joint: ElementTree.Element, file: str) -> Iterator[Problem]:
    limit = joint.find("limit")
    if limit is None:
        return
    key = f"joint {joint.get('name')}, limit"
    lower, upper = _value(limit, "lower"), _value(limit, "upper")
    if lower is not None and upper is not None and lower > upper:
        yield Problem(file, f"{key} lower", f"{lower:g}", f"allowed is at most upper, which is {upper:g}")
    for name in ("velocity", "effort"):
        value = _value(limit, name)
        if value is not None and value < 0.0:
            yield Problem(file, f"{key} {name}", f"{value:g}", "allowed is 0 or more")


def _shape_problems(link: ElementTree.Element, file: str, folder: Path | None) -> Iterator[Problem]:
    for shape in (*link.iterfind("collision/geometry/*"), *link.iterfind("visual/geometry/*")):
        key = f"link {link.get('name')}, {shape.tag}"
        for name in SIZES.get(str(shape.tag), ()):
            text = shape.get(name, "")
            try:
                good = [value for value in map(float, text.split()) if math.isfinite(value) and value > 0.0]
            except ValueError:
                good = []
            if len(good) != len(text.split()) or len(good) != (3 if name == "size" else 1):
                count = "three numbers" if name == "size" else "a number"
                yield Problem(file, f"{key} {name}", repr(text), f"allowed is {count} above 0 m")
        if shape.tag == "mesh" and folder is not None and not _mesh_is_there(shape.get("filename", ""), folder):
            allowed = "there is no such file: give it, or take the mesh out (only boxes, spheres and cylinders collide)"
            yield Problem(file, key, repr(shape.get("filename", "")), allowed)


def _mesh_is_there(name: str, folder: Path) -> bool:
    """A path from the URDF's folder, a file: URL, or package://NAME/PATH, where a folder above it is the package."""
    url = urlparse(name)
    if url.scheme == "package":
        inside = unquote(url.path).lstrip("/")
        places = (inside, url.netloc + url.path)
        return any((above / place).is_file() for above in folder.resolve().parents for place in places)
    path = Path(unquote(url.path) if url.scheme == "file" else name)
    return bool(name) and (folder / path).is_file()


def _value(element: ElementTree.Element, name: str) -> float | None:
    """A number that can be read; others are told where they are needed."""
    try:
        return float(element.get(name, ""))
    except ValueError:
        return None
