"""The type of /tf, tf2_msgs/TFMessage, for messages that come and go as bytes.

No wheel has the package, and building it takes a compiler. Where messages are
serialized already the middleware asks little of a type, though: its name, hash,
description and members. These follow from the public definition, which stands here,
and from the type nested in it, which is installed. The structures are those of rosidl
in Jazzy (`message_type_support_struct.h`, `message_type_support.h` for Fast DDS and
`message_introspection.h`). They are tried on the nested type first: where they do not
fit, there is no /tf, and nothing else is lost.
"""

from __future__ import annotations

import ctypes
from ctypes import (
    CFUNCTYPE,
    POINTER,
    Structure,
    addressof,
    c_bool,
    c_char_p,
    c_size_t,
    c_uint8,
    c_uint32,
    c_uint64,
    c_void_p,
    cast,
    sizeof,
)
from functools import cache
from importlib import import_module
from typing import Any

from geometry_msgs.msg import TransformStamped
from rclpy.type_support import check_for_type_support

TF_TYPE = "tf2_msgs/msg/TFMessage"
TF_DEFINITION = "geometry_msgs/TransformStamped[] transforms\n"
TF_TYPE_HASH = "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
"""Follows from the definition and from those nested in it."""

_NESTED = b"geometry_msgs/msg/TransformStamped"
_DISPATCHER = b"rosidl_typesupport_c"
_FAST_DDS = b"rosidl_typesupport_fastrtps_c"
_INTROSPECTION = b"rosidl_typesupport_introspection_c"
_UNBOUNDED_SEQUENCE_OF_NESTED = 145  # of type_description_interfaces/FieldType
_MESSAGE = 18  # of rosidl's introspection
_HASH_VERSION = 1
_UNBOUNDED = 0  # of the size that a message can have

_FIND = CFUNCTYPE(c_void_p, c_void_p, c_char_p)
_GET = CFUNCTYPE(c_void_p, c_void_p)
_CODE = CFUNCTYPE(c_bool, c_void_p, c_void_p)
_SIZE = CFUNCTYPE(c_uint32, c_void_p)
_BOUND = CFUNCTYPE(c_size_t, POINTER(c_uint8))


class _TypeSupport(Structure):
    _fields_ = (
        ("identifier", c_char_p),
        ("data", c_void_p),
        ("find", _FIND),
        ("hash", _GET),
        ("description", _GET),
        ("sources", _GET),
    )


class _Callbacks(Structure):
    _fields_ = (
        ("namespace", c_char_p),
        ("name", c_char_p),
        ("serialize", _CODE),
        ("deserialize", _CODE),
        ("size", _SIZE),
        ("largest_size", _BOUND),
        ("key_callbacks", c_void_p),
    )


class _Member(Structure):
    _fields_ = (
        ("name", c_char_p),
        ("type_id", c_uint8),
        ("string_bound", c_size_t),
        ("type_support", c_void_p),
        ("is_key", c_bool),
        ("is_array", c_bool),
        ("array_size", c_size_t),
        ("is_upper_bound", c_bool),
        ("offset", c_uint32),
        ("default", c_void_p),
        ("functions", c_void_p * 6),
    )


class _Members(Structure):
    _fields_ = (
        ("namespace", c_char_p),
        ("name", c_char_p),
        ("count", c_uint32),
        ("size", c_size_t),
        ("has_key", c_bool),
        ("members", POINTER(_Member)),
        ("initialize", c_void_p),
        ("finalize", c_void_p),
    )


class _Hash(Structure):
    _fields_ = (("version", c_uint8), ("value", c_uint8 * 32))


class _String(Structure):
    _fields_ = (("data", c_char_p), ("size", c_size_t), ("capacity", c_size_t))


class _Sequence(Structure):
    _fields_ = (("data", c_void_p), ("size", c_size_t), ("capacity", c_size_t))


class _Field(Structure):
    _fields_ = (
        ("name", _String),
        ("type_id", c_uint8),
        ("capacity", c_uint64),
        ("string_capacity", c_uint64),
        ("nested_type", _String),
        ("default", _String),
    )


class _Type(Structure):
    _fields_ = (("name", _String), ("fields", _Sequence))


class _Description(Structure):
    _fields_ = (("type", _Type), ("referenced", _Sequence))


@cache
def tf_message_class() -> Any:
    """Return a message class with which /tf is published and received as bytes.

    Where tf2_msgs is installed, as on a machine with ROS 2, it is that one.

    Raises:
        ImportError: the installed rosidl is another one than is known here.
    """
    try:
        return import_module("tf2_msgs.msg").TFMessage
    except ImportError:
        return _class_for_bytes()


def _class_for_bytes() -> Any:
    check_for_type_support(TransformStamped)
    pointer = _capsule_pointer(TransformStamped.__class__._TYPE_SUPPORT)
    nested = cast(pointer, POINTER(_TypeSupport)).contents
    _try_on(nested)
    members_of_nested = nested.find(pointer, _INTROSPECTION)
    hash_value = (c_uint8 * 32)(*bytes.fromhex(TF_TYPE_HASH.removeprefix("RIHS01_")))
    kept: list[Any] = [nested]
    described = cast(nested.description(pointer), POINTER(_Description)).contents
    about = [
        _Hash(_HASH_VERSION, hash_value),
        _description(described, kept),
        _Sequence(),  # of sources: none
    ]
    # Never called on bytes; an object would be refused.
    no_code, no_size = _CODE(lambda *_: False), _SIZE(lambda _: 0)
    callbacks = _Callbacks(
        b"tf2_msgs::msg", b"TFMessage", no_code, no_code, no_size, _BOUND(_largest_size)
    )
    member = _Member(
        name=b"transforms",
        type_id=_MESSAGE,
        type_support=members_of_nested,
        is_array=True,
    )
    members = _Members(
        namespace=b"tf2_msgs__msg",
        name=b"TFMessage",
        count=1,
        size=sizeof(_Sequence),
        members=ctypes.pointer(member),
    )

    @_FIND
    def find(_: int, identifier: bytes) -> int | None:
        return addressof(supports[identifier]) if identifier in supports else None

    getters = [_GET(lambda _, each=each: addressof(each)) for each in about]
    supports = {
        identifier: _TypeSupport(identifier, addressof(data), find, *getters)
        for identifier, data in ((_FAST_DDS, callbacks), (_INTROSPECTION, members))
    }

    class OfTypes(type):
        """Where rclpy looks for a type's support."""

        _TYPE_SUPPORT = _new_capsule(addressof(supports[_FAST_DDS]))
        _CREATE_ROS_MESSAGE = _CONVERT_FROM_PY = _TYPE_SUPPORT
        _CONVERT_TO_PY = _DESTROY_ROS_MESSAGE = _TYPE_SUPPORT

    class TFMessage(metaclass=OfTypes):
        """A type of which there are bytes only."""

        pointed_to = (*kept, callbacks, member, members, about, getters, supports)

        def __init__(self) -> None:
            raise TypeError(f"{TF_TYPE}: there are serialized messages only")

    return TFMessage


def _try_on(nested: _TypeSupport) -> None:
    """Read the nested type as ours is written.

    Raises:
        ImportError: something is not where it should be.
    """
    pointer = addressof(nested)

    def read(identifier: bytes, kind: Any) -> Any:
        found = nested.find(pointer, identifier)
        if found is None:
            raise ImportError(f"{TF_TYPE}: rosidl has no {identifier.decode()}")
        return cast(cast(found, POINTER(_TypeSupport)).contents.data, POINTER(kind))[0]

    callbacks = read(_FAST_DDS, _Callbacks)
    members = read(_INTROSPECTION, _Members)
    described = cast(nested.description(pointer), POINTER(_Description)).contents
    fields = cast(described.type.fields.data, POINTER(_Field))
    if (
        nested.identifier != _DISPATCHER
        or (callbacks.namespace, callbacks.name)
        != (b"geometry_msgs::msg", b"TransformStamped")
        or (members.namespace, members.name, members.count)
        != (b"geometry_msgs__msg", b"TransformStamped", 3)
        or [(m.name, m.type_id) for m in members.members[:3:2]]
        != [(b"header", _MESSAGE), (b"transform", _MESSAGE)]
        or (described.type.name.data, described.type.fields.size) != (_NESTED, 3)
        or fields[2].nested_type.data != b"geometry_msgs/msg/Transform"
        or cast(nested.hash(pointer), POINTER(_Hash))[0].version != _HASH_VERSION
    ):
        raise ImportError(f"{TF_TYPE}: the installed rosidl is not that of ROS 2 Jazzy")


def _description(nested: _Description, kept: list[Any]) -> _Description:
    """Return the description of the type, from that of the nested one.

    Args:
        nested: its description.
        kept: gets what the description points to.
    """

    def text(octets: bytes) -> _String:
        kept.append(octets)
        return _String(octets, len(octets), len(octets) + 1)

    def sequence(items: list[Any]) -> _Sequence:
        kept.append((type(items[0]) * len(items))(*items))
        return _Sequence(addressof(kept[-1]), len(items), len(items))

    field = _Field(
        name=text(b"transforms"),
        type_id=_UNBOUNDED_SEQUENCE_OF_NESTED,
        nested_type=text(_NESTED),
        default=text(b""),
    )
    below = cast(nested.referenced.data, POINTER(_Type))[: nested.referenced.size]
    referenced = sorted((nested.type, *below), key=lambda each: bytes(each.name.data))
    own = _Type(text(TF_TYPE.encode()), sequence([field]))
    return _Description(own, sequence(referenced))


def _largest_size(bound: Any) -> int:
    bound[0] = _UNBOUNDED
    return 4  # of an empty sequence


def _capsule_pointer(capsule: Any) -> int:
    get = ctypes.pythonapi.PyCapsule_GetPointer
    get.restype, get.argtypes = c_void_p, (ctypes.py_object, c_char_p)
    return int(get(capsule, None))


def _new_capsule(pointer: int) -> Any:
    new = ctypes.pythonapi.PyCapsule_New
    new.restype, new.argtypes = ctypes.py_object, (c_void_p, c_char_p, c_void_p)
    return new(pointer, None, None)
