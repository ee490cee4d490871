"""ROS message classes by the names that the topic table uses."""

from functools import cache
from importlib import import_module
from typing import Any


@cache
def message_class(name: str) -> Any:
    """Class of a message type "package/Name". Raises ImportError or AttributeError if it is not installed."""
    package, _, short = name.partition("/")
    return getattr(import_module(f"{package}.msg"), short)
