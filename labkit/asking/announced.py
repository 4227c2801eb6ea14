"""What the processes of a domain announce: the endpoints of their nodes, also those to come.

Each process publishes on `ros_discovery_info` which endpoints its nodes have, and the last message
is kept for those who come later. DDS tells of the endpoints themselves in streams of their own,
which may stand still for a second on a busy machine. So what has been announced and is not in the
graph yet is known to come. rclpy puts a slash in front of each topic, hence the C functions below
it. Source: rmw_dds_common 3.1, ParticipantEntitiesInfo.msg; rmw 7.3, rmw/types.h.
"""

from __future__ import annotations

import ctypes
from ctypes import POINTER, Structure, byref, c_bool, c_char_p, c_int, c_size_t, c_uint64, c_void_p
from typing import Any

from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rclpy.type_support import check_for_type_support
from rmw_dds_common.msg import ParticipantEntitiesInfo

from labkit.rosgraph.whose import participant_of

__all__ = ['Announced']

_TOPIC = 'ros_discovery_info'
_KEEP_ALL, _RELIABLE, _TRANSIENT_LOCAL = 2, 1, 1
_GID_BYTES = 16


class _Time(Structure):
    _fields_ = (('sec', c_uint64), ('nsec', c_uint64))


class _Profile(Structure):
    _fields_ = (
        ('history', c_int),
        ('depth', c_size_t),
        ('reliability', c_int),
        ('durability', c_int),
        ('deadline', _Time),
        ('lifespan', _Time),
        ('liveliness', c_int),
        ('lease_duration', _Time),
        ('avoid_ros_namespace_conventions', c_bool),
    )


class _Options(Structure):
    _fields_ = (
        ('payload', c_void_p),
        ('ignore_local_publications', c_bool),
        ('unique_network_flow', c_int),
        ('content_filter', c_void_p),
    )


class _Allocator(Structure):
    _fields_ = tuple(
        (name, c_void_p)
        for name in ('allocate', 'deallocate', 'reallocate', 'zero_allocate', 'state')
    )


class _Bytes(Structure):
    _fields_ = (
        ('buffer', POINTER(ctypes.c_ubyte)),
        ('length', c_size_t),
        ('capacity', c_size_t),
        ('allocator', _Allocator),
    )


def _function(library: str, name: str, result: Any, *args: Any) -> Any:
    # Loaded by rclpy already, so its name is enough.
    function = getattr(ctypes.CDLL(f'{library}.so'), name)
    function.restype, function.argtypes = result, args
    return function


class Announced:
    """The announcements of the processes in the domain of a node, for a `with` block.

    Args:
        node: The node.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        # Participant -> GUIDs of its endpoints.
        self._told: dict[bytes, set[bytes]] = {}
        rmw = 'librmw_fastrtps_cpp'
        self._take = _function(
            *(rmw, 'rmw_take_serialized_message', c_int),
            *(c_void_p, POINTER(_Bytes), POINTER(c_bool), c_void_p),
        )
        self._destroy = _function(rmw, 'rmw_destroy_subscription', c_int, c_void_p, c_void_p)
        self._free = _function('librcutils', 'rcutils_uint8_array_fini', c_int, POINTER(_Bytes))
        allocator = _function('librcutils', 'rcutils_get_default_allocator', _Allocator)()
        self._bytes = _Bytes(allocator=allocator)
        create = _function(
            *(rmw, 'rmw_create_subscription', c_void_p, c_void_p, c_void_p, c_char_p),
            *(POINTER(_Profile), POINTER(_Options)),
        )
        profile = _Profile(
            history=_KEEP_ALL,
            reliability=_RELIABLE,
            durability=_TRANSIENT_LOCAL,
            avoid_ros_namespace_conventions=True,
        )
        with node.handle:
            own = self._own_handle()
            self._subscription = create(
                own, _type_support(), _TOPIC.encode(), byref(profile), byref(_Options())
            )
        if not self._subscription:
            raise RuntimeError(f'{_TOPIC} can not be subscribed to.')

    def __enter__(self) -> Announced:
        return self

    def __exit__(self, *_: object) -> None:
        with self._node.handle:
            self._destroy(self._own_handle(), self._subscription)
        self._free(byref(self._bytes))

    def participants(self) -> int:
        """Return the number of participants in the graph of whose endpoints none is missing."""
        self._read()
        found: set[bytes] = set()
        living: set[bytes] = set()
        for topic, _ in self._node.get_topic_names_and_types(no_demangle=True):
            for ask in (
                self._node.get_publishers_info_by_topic,
                self._node.get_subscriptions_info_by_topic,
            ):
                gids = {
                    bytes(info.endpoint_gid)[:_GID_BYTES] for info in ask(topic, no_mangle=True)
                }
                found |= gids
                if topic == _TOPIC:
                    living |= set(map(participant_of, gids))
        return sum(one in living and gids <= found for one, gids in self._told.items())

    def note(self, message: Any) -> None:
        """Note an announcement, which replaces the last one of its participant."""
        self._told[participant_of(bytes(message.gid.data))] = {
            bytes(gid.data)[:_GID_BYTES]
            for entry in message.node_entities_info_seq
            for gid in (*entry.reader_gid_seq, *entry.writer_gid_seq)
        }

    def _read(self) -> None:
        taken = c_bool(True)
        while taken.value:
            taken.value = False
            with self._node.handle:
                self._take(self._subscription, byref(self._bytes), byref(taken), None)
            if taken.value:
                data = bytes(self._bytes.buffer[: self._bytes.length])
                self.note(deserialize_message(data, ParticipantEntitiesInfo))

    def _own_handle(self) -> Any:
        handle_of = _function('librcl', 'rcl_node_get_rmw_handle', c_void_p, c_void_p)
        return handle_of(self._node.handle.pointer)


def _type_support() -> Any:
    check_for_type_support(ParticipantEntitiesInfo)  # type: ignore[no-untyped-call]
    pointer_in = ctypes.pythonapi.PyCapsule_GetPointer
    pointer_in.restype, pointer_in.argtypes = c_void_p, (ctypes.py_object, c_char_p)
    return pointer_in(type(ParticipantEntitiesInfo)._TYPE_SUPPORT, None)
