"""Names that no client library makes, from a program that speaks to the middleware itself."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any, cast

import pytest
from background.talker import LOCALHOST

from labkit.background.domains import claim_domain
from labkit.rosgraph import listings

# Topics, and nodes that publish on them, past all that validates names.
FORGER = r"""
import ctypes as c, sys, time
import rclpy
from rclpy.node import Node
from rclpy.serialization import serialize_message
from rclpy.type_support import check_for_type_support
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo
from std_msgs.msg import String

class Time(c.Structure):
    _fields_ = [('sec', c.c_uint64), ('nsec', c.c_uint64)]

class Profile(c.Structure):
    _fields_ = [('history', c.c_int), ('depth', c.c_size_t), ('reliability', c.c_int),
                ('durability', c.c_int), ('deadline', Time), ('lifespan', Time),
                ('liveliness', c.c_int), ('lease', Time), ('without_conventions', c.c_bool)]

class Options(c.Structure):
    _fields_ = [('payload', c.c_void_p), ('unique', c.c_int)]

class Identity(c.Structure):
    _fields_ = [('implementation', c.c_char_p), ('data', c.c_uint8 * 16)]

class Bytes(c.Structure):
    _fields_ = [('buffer', c.c_char_p), ('length', c.c_size_t), ('most', c.c_size_t),
                ('allocator', c.c_void_p * 5)]

rclpy.init()
node = Node('forger', start_parameter_services=False)
rcl, rmw = c.CDLL('librcl.so'), c.CDLL('librmw_fastrtps_cpp.so')
rcl.rcl_node_get_rmw_handle.restype = rmw.rmw_create_publisher.restype = c.c_void_p
pointer, name_of = c.pythonapi.PyCapsule_GetPointer, c.pythonapi.PyCapsule_GetName
pointer.restype, pointer.argtypes = c.c_void_p, [c.py_object, c.c_char_p]
name_of.restype, name_of.argtypes = c.c_char_p, [c.py_object]
with node.handle:
    handle = c.c_void_p(rcl.rcl_node_get_rmw_handle(c.c_void_p(node.handle.pointer)))

def publisher(kind, topic):
    check_for_type_support(kind)
    support = kind._TYPE_SUPPORT
    profile = Profile(1, 10, 1, 1, Time(), Time(), 1, Time(), True)
    return c.c_void_p(rmw.rmw_create_publisher(
        handle, c.c_void_p(pointer(support, name_of(support))),
        topic.encode(errors='surrogateescape'),
        c.byref(profile), c.byref(Options())))

def identity(made):
    found = Identity()
    assert rmw.rmw_get_gid_for_publisher(made, c.byref(found)) == 0
    return bytes(found.data)

def gid(data):
    return Gid(data=list(data))

IMAGE = '<img src=x onerror=alert(1)>'
topics = ['rt/fine', f'rt/{IMAGE}', 'rt/\x1b[2Jx', 'rt/a\nb', 'rt/two//slashes', 'rt/fine2']
if sys.argv[1:] == ['bytes']:
    topics += ['rt/\udcff']
made = [publisher(String, topic) for topic in topics]
names = [(IMAGE, f'/{IMAGE}'), ('\x1b[2Jx', '/'), ('a\nb', '/'), ('1', '/'), ('x', '/a/../b'),
         ('x', '/')]
if sys.argv[1:] == ['empty']:
    names[0] = '', '/'
told = ParticipantEntitiesInfo(gid=gid(identity(made[0])[:12] + bytes([0, 0, 1, 0xC1])))
told.node_entities_info_seq = [
    NodeEntitiesInfo(node_name=name, node_namespace=space, writer_gid_seq=[gid(identity(each))])
    for each, (name, space) in zip(made, names)
]
data = serialize_message(told)
message = Bytes(data, len(data), len(data))
graph = publisher(ParticipantEntitiesInfo, 'ros_discovery_info')
while True:
    assert rmw.rmw_publish_serialized_message(graph, c.byref(message), None) == 0
    time.sleep(0.1)
"""
BEGIN = """
import json, subprocess, sys
import labkit as lab
from labkit.asking.discovery import wait_until_announced
from labkit.background.runtime import runtime
from labkit.rosgraph.snapshot import node_names, read_graph
from labkit.silent.watch import watch
from rclpy.node import Node

lab.start()
node = lab.spin(Node('learner'))
forger = subprocess.Popen([sys.executable, '-c', FORGER, *KIND])
"""
VICTIM = """
def is_there():
    assert forger.poll() is None
    spaces = {space for _, space in node.get_node_names_and_namespaces()}
    topics = dict(node.get_topic_names_and_types())
    return '/a/../b' in spaces and {'/fine2', '/two//slashes'} <= topics.keys()

try:
    lab.wait_until(is_there, timeout_sec=60)
    graph = read_graph(runtime.helper, include_hidden=True, include_services=True)
    wait_until_announced(runtime.helper)
    watch.look()
    drawn = lab.graph(live=False)._repr_mimebundle_()
finally:
    forger.kill()
print(json.dumps([
    [topic.name for topic in graph.topics if 'std_msgs/msg/String' in topic.types],
    [name for name in node_names(runtime.helper) if name in ('/learner', '/x')],
    str(graph), drawn['image/svg+xml'],
]))
"""


REFUSED = """
reasons = []

def is_refused():
    assert forger.poll() is None
    try:
        lab.graph(live=False)
    except lab.LabError as error:
        reasons.append(str(error))
    return bool(reasons)

try:
    lab.wait_until(is_refused, timeout_sec=60)
    print(*reasons)
finally:
    forger.kill()
"""


def run(script, code, *kind):
    claim = claim_domain()
    begin = f'FORGER, KIND = {FORGER!r}, {kind!r}\n{BEGIN}'
    result = script(begin + code, **LOCALHOST, ROS_DOMAIN_ID=str(claim.domain_id))
    claim.close()
    assert result.exit_code == 0, result.stderr
    return result.stdout


@pytest.mark.slow('starts other processes')
def test_forged_names_neither_stop_the_graph_nor_run(script):
    said = run(script, VICTIM)
    topics, nodes, text, picture = json.loads(said.splitlines()[-1])
    assert topics == ['/fine', '/fine2']
    assert nodes == ['/learner', '/x']
    assert '\x1b' not in text and '\x1b' not in picture
    assert '&lt;img' in picture and '<img' not in picture


@pytest.mark.slow('starts other processes')
@pytest.mark.parametrize('kind', ['empty', 'bytes'])
def test_a_name_that_keeps_ros_from_all_others_is_told(script, kind):
    assert 'announces a name that is empty or no text' in run(script, REFUSED, kind)


def test_a_forged_type_moves_no_terminal():
    found = [('/a', ['std_msgs/msg/String', '\x1b[2Jx']), ('/b\n', ['x'])]
    forger = cast(Any, SimpleNamespace(get_topic_names_and_types=lambda: found))
    assert listings.topics(forger) == [('/a', ['std_msgs/msg/String', '?[2Jx']), ('/b?', ['x'])]
    assert listings.topic_types(forger, '/a')[1] == '?[2Jx'
