"""The class of tf2_msgs/TFMessage, for publishers and readers of bytes.

Where the package is installed it is that of the package. The wheels of the ROS library have none: there it is made of
what they have. To the middleware a type is a table in C (rosidl_runtime_c of Jazzy, message_type_support_struct.h): a
name, a hash, and by the name of an implementation a further table. Two are asked for: that of the serialiser
(rosidl_typesupport_fastrtps_c, message_type_support.h), of which bytes that are made already need nothing but sizes
without a bound, and that of the members (rosidl_typesupport_introspection_c, message_introspection.h), which other
participants are told. Both are copies of nav_msgs/Path's, a message that ends with a sequence of stamped things, with
this type's names and hash, and with TransformStamped in the sequence. Messages themselves, not bytes, cannot be sent.
"""

import ctypes
from functools import cache
from typing import Any

from sojourn_bags.definitions import full_type, type_hash
from sojourn_bags.errors import TransformTypeError
from sojourn_contract.types import message_class

NAME = "tf2_msgs/TFMessage"
FAST, MEMBERS, CHOICE = (
    b"rosidl_typesupport_" + word for word in (b"fastrtps_c", b"introspection_c", b"c")
)  # fmt: skip
_Find = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p)
_Hash = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)


class _Support(ctypes.Structure):
    """rosidl_message_type_support_t."""

    _fields_ = (
        ("implementation", ctypes.c_char_p),
        ("data", ctypes.c_void_p),
        ("find", ctypes.c_void_p),
        ("hash", ctypes.c_void_p),
        ("description", ctypes.c_void_p),
        ("sources", ctypes.c_void_p),
    )

    def of(self, implementation: bytes) -> "_Support":
        """That of an implementation. Raises TransformTypeError where there is none."""
        found = _Find(self.find)(ctypes.addressof(self), implementation)
        if not found:
            raise TransformTypeError(f"no {implementation.decode()}")
        return _Support.from_address(found)


class _Callbacks(ctypes.Structure):
    """message_type_support_callbacks_t."""

    _fields_ = (("namespace", ctypes.c_char_p), ("name", ctypes.c_char_p), ("functions", ctypes.c_void_p * 5))


class _Members(ctypes.Structure):
    """rosidl_typesupport_introspection_c__MessageMembers."""

    _fields_ = (
        ("namespace", ctypes.c_char_p),
        ("name", ctypes.c_char_p),
        ("count", ctypes.c_uint32),
        ("size", ctypes.c_size_t),
        ("has_key", ctypes.c_bool),
        ("members", ctypes.c_void_p),
        ("functions", ctypes.c_void_p * 2),
    )


class _Member(ctypes.Structure):
    """rosidl_typesupport_introspection_c__MessageMember."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("kind", ctypes.c_uint8),
        ("longest_text", ctypes.c_size_t),
        ("support", ctypes.c_void_p),
        ("is_key", ctypes.c_bool),
        ("is_sequence", ctypes.c_bool),
        ("length", ctypes.c_size_t),
        ("is_bounded", ctypes.c_bool),
        ("offset", ctypes.c_uint32),
        ("default", ctypes.c_void_p),
        ("functions", ctypes.c_void_p * 6),
    )


@cache
def transform_message_class() -> Any:
    """Of tf2_msgs/TFMessage. Raises TransformTypeError where it is neither installed nor can be made."""
    try:
        return message_class(NAME)
    except (ImportError, AttributeError):
        return _made()


def _made() -> Any:
    kept: list[Any] = []  # what C points to lives as long as the class
    path = _support_of("nav_msgs/Path")
    name_space, _, name = NAME.partition("/")

    callbacks = _Callbacks.from_address(path.of(FAST).data)
    _require((callbacks.namespace, callbacks.name) == (b"nav_msgs::msg", b"Path"), "callbacks")
    callbacks = _Callbacks.from_buffer_copy(callbacks)
    callbacks.namespace, callbacks.name = f"{name_space}::msg".encode(), name.encode()

    members = _Members.from_address(path.of(MEMBERS).data)
    _require((members.namespace, members.name, members.count) == (b"nav_msgs__msg", b"Path", 2), "members")
    header, poses = (_Member * 2).from_address(members.members)
    _require((header.name, poses.name, poses.is_sequence) == (b"header", b"poses", True), "a member")
    transforms = _Member.from_buffer_copy(poses)
    transforms.name, transforms.offset = b"transforms", 0
    transforms.support = ctypes.addressof(_support_of("geometry_msgs/TransformStamped").of(MEMBERS))
    members = _Members.from_buffer_copy(members)
    members.namespace, members.name = f"{name_space}__msg".encode(), name.encode()
    members.count, members.members, members.size = 1, ctypes.addressof(transforms), members.size - poses.offset

    version, _, digest = type_hash(full_type(NAME)).partition("_")
    told = ctypes.create_string_buffer(bytes([int(version.removeprefix("RIHS"))]) + bytes.fromhex(digest))
    own_hash = _Hash(lambda _: ctypes.addressof(told))
    tables: dict[bytes, int] = {}
    find = _Find(lambda _, implementation: tables.get(implementation, 0))
    for implementation, data in ((FAST, callbacks), (MEMBERS, members), (CHOICE, None)):
        table = _Support.from_buffer_copy(path)
        table.implementation = implementation
        table.data = None if data is None else ctypes.addressof(data)
        table.find, table.hash = (ctypes.cast(function, ctypes.c_void_p) for function in (find, own_hash))
        tables[implementation] = ctypes.addressof(table)
        kept += [table, data]
    kept += [transforms, told, own_hash, find]
    return _class_of(tables[CHOICE], kept)


def _class_of(table: int, kept: list[Any]) -> Any:
    """A class as the ROS library's publishers and readers look for one."""
    make = ctypes.pythonapi.PyCapsule_New
    make.restype, make.argtypes = ctypes.py_object, (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)

    class Metaclass(type):
        _TYPE_SUPPORT = make(table, None, None)
        _CREATE_ROS_MESSAGE = _CONVERT_FROM_PY = _CONVERT_TO_PY = _DESTROY_ROS_MESSAGE = "bytes alone"
        _KEPT = kept

        @classmethod
        def __import_type_support__(cls) -> None:
            """It is there."""

    return Metaclass(NAME.partition("/")[2], (), {})


def _support_of(name: str) -> _Support:
    kind = type(message_class(name))
    kind.__import_type_support__()
    pointer = ctypes.pythonapi.PyCapsule_GetPointer
    pointer.restype, pointer.argtypes = ctypes.c_void_p, (ctypes.py_object, ctypes.c_char_p)
    support = _Support.from_address(pointer(kind._TYPE_SUPPORT, None))
    _require(support.implementation == CHOICE, f"type support of {name}")
    return support


def _require(holds: bool, part: str) -> None:
    if not holds:
        raise TransformTypeError(f"{part} of another layout")
