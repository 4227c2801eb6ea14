"""Frames, see `labkit.silent.frame_faults`."""

_TELL = """
from geometry_msgs.msg import TransformStamped
from tf2_ros import Buffer, StaticTransformBroadcaster, TransformBroadcaster, TransformListener

def transform(parent, child, x=0.0, ahead=0.0):
    t = TransformStamped(child_frame_id=child); t.header.frame_id = parent
    t.header.stamp = (runtime.helper.get_clock().now() + Duration(seconds=ahead)).to_msg()
    t.transform.translation.x, t.transform.rotation.w = x, 1.0
    return t

def moving(name, *steps, **more):
    n = node(name); b = TransformBroadcaster(n)
    n.create_timer(0.02, lambda: b.sendTransform([transform(*step, **more) for step in steps]))
    return n

def fixed(name, *steps):
    b = StaticTransformBroadcaster(node(name)); b.sendTransform([transform(*s) for s in steps])
    return b

def hearing(name, *frames, ask=None):
    n = node(name); n.buffer = Buffer(); n.listener = TransformListener(n.buffer, n)
    n.create_timer(0.1, lambda: ask and n.buffer.can_transform(*ask, rclpy.time.Time()))
    known = lambda: set(frames) <= set(n.buffer.tree.names())
    lab.wait_until(known, timeout_sec=20)
    if ask:
        long = lambda: any(sec > 2 for sec in n.buffer.in_vain().values())
        lab.wait_until(lambda: long() or n.buffer.can_transform(*ask, rclpy.time.Time()))
    return n

def sent(n, count):
    lab.wait_until(lambda: runtime.entry_of(n).callbacks >= count, timeout_sec=20)
"""
_ROBOT = "r = moving('robot', ('odom', 'base_link')); "
_SCAN = 'm = scan(); m.header.frame_id = {frame!r}; say(m)'
_ASKED = "h = hearing('hearer', 'odom', 'base_link', ask={ask!r})"
_TWO = "a = moving('a', {a}); b = moving('b', {b}); sent(a, 9); sent(b, 9)"
_BASE = "('odom', 'base_link')"
_STATIC = (
    "f = fixed('arm', ('base_link', 'arm'))\n"
    'for number in range({count}):\n'
    "    f.sendTransform(transform('base_link', 'arm', {x}))\n"
)
# As if it had been sent some seconds ago.
_ONCE = (
    "b.sendTransform(transform('a', 'b')); s = b.pub_tf._labkit_sent\n"
    'for each in s.parts.values(): each.last -= 6.0\n'
    's.last -= 6.0'
)
# A node of another participant, whose messages nobody looks into as those of other processes.
_OTHER = (
    "o = other_process('bag'); from tf2_msgs.msg import TFMessage\n"
    "p = o.create_publisher(TFMessage, '/tf', 10); publish = type(p).publish.__wrapped__\n"
    'def play():\n'
    "    publish(p, TFMessage(transforms=[transform('odom', 'base_link', ahead={ahead})]))\n"
    "h = node('hearer'); h.create_timer(0.02, play)\n"
    'h.buffer = Buffer(); h.listener = TransformListener(h.buffer, h)\n'
    "lab.wait_until(lambda: 'odom' in h.buffer.tree.names(), timeout_sec=20)"
)

CASES = {
    id: tuple(_TELL + code for code in two)
    for id, two in {
        'frames.unknown': (
            f'{_ROBOT}sent(r, 3); {_SCAN.format(frame="laser")}',
            f"{_ROBOT}f = fixed('mount', ('base_link', 'laser')); sent(r, 3)\n"
            f'{_SCAN.format(frame="laser")}; '
            f'{_ASKED.format(ask=("odom", "laser"))}',
        ),
        'frames.two-parents': (
            _TWO.format(a=_BASE, b="('map', 'base_link')"),
            _TWO.format(a=_BASE, b="('map', 'odom')"),
        ),
        'frames.two-publishers': (
            _TWO.format(a=_BASE, b=_BASE),
            f"a = fixed('a', {_BASE}); b = fixed('b', {_BASE})",
        ),
        'frames.loop': (
            _TWO.format(a=_BASE, b="('base_link', 'odom')"),
            _TWO.format(a=_BASE, b="('odom', 'map')"),
        ),
        'frames.apart': (
            f"{_ROBOT}c = fixed('c', ('camera', 'lens'))\n{_ASKED.format(ask=('odom', 'lens'))}",
            "a = moving('a', ('a/odom', 'a/base')); b = moving('b', ('b/odom', 'b/base'))\n"
            "h = hearing('hearer', 'a/odom', 'b/odom')",
        ),
        'frames.clock': (_OTHER.format(ahead=-3600.0), _OTHER.format(ahead=-0.5)),
        'frames.once': (
            f"b = TransformBroadcaster(node('n')); {_ONCE}",
            f"b = StaticTransformBroadcaster(node('n')); {_ONCE}",
        ),
        'frames.static-moves': (
            _STATIC.format(count=6, x='0.1 * number'),
            _STATIC.format(count=6, x='0.5'),
        ),
    }.items()
}
