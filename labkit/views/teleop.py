"""Drive a robot by hand: keys, mouse or touch become Twist messages. `lab.teleop()`.

The page sends a direction while a key is held; the node publishes. If anything goes wrong between
them, the robot stops: the page stops it when it loses focus, and the node stops it when the page
falls silent.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

from labkit.background.nodes import destroy_node, helper_node, node_exists
from labkit.background.runtime import runtime
from labkit.errors import LabError, first_few, quoted
from labkit.rosgraph.endpoints import subscriptions
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.names import full_node_name
from labkit.sim.robots import BURGER
from labkit.views.arena_picture import two
from labkit.views.live import live_views
from labkit.views.live_page import LivePage, Update

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['Teleop', 'teleop']

# Commands are published this often while a key is held, Hz.
RATE = 10.0
# The page repeats itself ten times a second. If it does not, it is gone or unreachable.
SILENCE_SEC = 0.5
QUEUE_DEPTH = 10
# Speeds that `+` and `-` step through, as shares of the maximum.
STEPS = (0.25, 0.5, 0.75, 1.0)
FIRST_STEP = 3
# A key turns at this share of the turning rate: a tap of 0.1 s turns a Burger by 8 degrees.
KEY_TURN = 0.5

_KEYS = """\
  w or ↑   forward       x or ↓   backward
  a or ←   turn left     d or →   turn right
  s or space   stop      + or -   faster or slower"""


class Teleop(LivePage):
    """A node that publishes a person's commands, to be shown in a cell; see `teleop`.

    The page sends a direction as two numbers from -1 to 1: `v` forwards and `w` to the left.

    Attributes:
        topic: Full name of its topic.
        published: Speeds of the last command, m/s and rad/s; None before the first.
        count: Number of published commands.
    """

    _name = 'teleop'
    _period = 0.1
    node: Node = None  # type: ignore[assignment]  # until it is opened

    def __init__(
        self,
        *,
        topic: str,
        namespace: str,
        name: str,
        max_speed: float,
        max_turn: float,
        stamped: bool,
    ) -> None:
        for label, value in (('max_speed', max_speed), ('max_turn', max_turn)):
            if not (isinstance(value, (int, float)) and 0 < value < math.inf):
                raise LabError(f'{label} must be a number above 0, but it is {quoted(value)}.')
        runtime.start()
        self.max_speed, self.max_turn = float(max_speed), float(max_turn)
        self.published: tuple[float, float] | None = None
        self.count = 0
        # The current direction, None while no key is held; and when the page sent it.
        self._direction: tuple[float, float] | None = None
        self._heard_at = 0.0
        self._listeners = 0
        self._msg_type = _message_class(stamped)
        # First: this closes the view of an earlier run of the cell.
        super().__init__()
        self._open_node(name, namespace, topic)
        # Even without a page: its node runs.
        self._start()

    def _open_node(self, name: str, namespace: str, topic: str) -> None:
        full_name = full_node_name(name, namespace)
        others = [view for view in _teleops() if view.node.get_fully_qualified_name() == full_name]
        # Teleops of one name share a node: the one in use drives.
        node = (
            others[0].node
            if others
            else helper_node(name, namespace=namespace or None, enable_rosout=True)
        )
        try:
            self._publisher = node.create_publisher(self._msg_type, topic, QUEUE_DEPTH)
        except LabError as error:
            todo = self._other_type(node, node.resolve_topic_name(topic))
            if not others:
                destroy_node(node)
            raise LabError(error.message, todo=todo or error.todo) from error
        self.node = node
        self.topic: str = self._publisher.topic_name
        self._repeat = self.node.create_timer(1 / RATE, self._drive)
        # A new direction is published at once, in the background, not at the next timer tick.
        self._new_direction = self.node.create_guard_condition(self._drive_now)
        if not others:
            runtime.add(self.node)

    # -- for cells ------------------------------------------------------------------------------

    def stop(self) -> None:
        """Stop the robot, even if a key is held."""
        with self._lock:
            self._direction = None
            self._publish(0.0, 0.0)

    def close(self) -> None:
        """Stop the robot and end the node."""
        super().close()

    def __repr__(self) -> str:
        share = STEPS[FIRST_STEP]
        return (
            f'Teleop publishes geometry_msgs/msg/{self._msg_type.__name__} on {self.topic}, '
            f'{RATE:.0f} times a second while a key is held.\n{_KEYS}\n'
            f'  at first {share:.0%} of full speed: {two(share * self.max_speed)} m/s, '
            f'{two(share * KEY_TURN * self.max_turn)} rad/s'
        )

    def _static(self) -> dict[str, str]:
        return {'text/plain': repr(self)}

    # -- the end --------------------------------------------------------------------------------

    def _close(self) -> None:
        with self._lock:
            # Nobody is looking, so nobody holds a key.
            if self._direction is not None:
                self.stop()
            super()._close()

    def _why_stopped(self) -> str:
        words = super()._why_stopped()
        if not words and self.node is not None and not node_exists(self.node):
            words = 'The node of this teleop has ended. Run this cell to start it again.'
        return words

    def _end(self, words: str) -> None:
        shared = any(view.node is self.node for view in _teleops() if view is not self)
        if not shared:
            self.stop()
        super()._end(words)
        if self.node is None or not node_exists(self.node):
            return
        if shared:
            self.node.destroy_timer(self._repeat)
            self.node.destroy_guard_condition(self._new_direction)
            self.node.destroy_publisher(self._publisher)
            return
        entry = runtime.entry_of(self.node)
        if entry is not None:
            runtime.discard(entry)
        else:
            destroy_node(self.node)

    # -- the page -------------------------------------------------------------------------------

    def _handle_request(self, content: dict[str, Any]) -> None:
        """Handle a direction, or a stop."""
        direction = content.get('v'), content.get('w')
        if content.get('stop'):
            self.stop()
        elif all(isinstance(part, (int, float)) and math.isfinite(part) for part in direction):
            v, w = (max(-1.0, min(1.0, float(part))) for part in direction if part is not None)
            is_new = self._direction != (v, w)
            self._direction, self._heard_at = (v, w), time.monotonic()
            if is_new and node_exists(self.node):
                self._new_direction.trigger()  # type: ignore[no-untyped-call]

    def _update(self, everything: bool) -> Update:
        deaf = self.published is not None and not self._listeners
        state = {
            'topic': self.topic,
            'speeds': [self.max_speed, self.max_turn],
            'steps': STEPS,
            'step': FIRST_STEP,
            'turn': KEY_TURN,
            'published': self.published,
            'count': self.count,
            'note': self._why_nobody_listens() if deaf else '',
        }
        return self._changes(state), []

    def _other_type(self, node: Node, topic: str) -> str:
        """Return who listens to the other kind of commands, and how to send it; '' if nobody."""
        stamped = self._msg_type is _message_class(False)
        other = type_name(_message_class(stamped))
        listeners = [end.node for end in subscriptions(node, topic) if end.msg_type == other]
        return (
            f'{listeners[0]} listens on {topic} to {other}. '
            f'For that: lab.teleop(stamped={stamped})'
            if listeners
            else ''
        )

    def _why_nobody_listens(self) -> str:
        if node_exists(self.node) and (words := self._other_type(self.node, self.topic)):
            return words
        end = self.topic[self.topic.rindex('/') :]
        names = self.node.get_topic_names_and_types() if node_exists(self.node) else []
        heard = sorted(
            topic
            for topic, _ in names
            if topic.endswith(end) and self.node.count_subscribers(topic)
        )
        words = f'Nobody listens on {self.topic}. '
        if not heard:
            return f'{words}Is the robot running?'
        space = heard[0].removesuffix(end).strip('/')
        return (
            f'{words}Somebody does on {first_few(heard)}. '
            f'Choose a robot: lab.teleop(namespace={space!r})'
        )

    # -- driving --------------------------------------------------------------------------------

    def _drive_now(self) -> None:
        # The next repetition is a full period from now.
        self._repeat.reset()  # type: ignore[no-untyped-call]
        self._drive()

    def _drive(self) -> None:
        with self._lock:
            if self._direction is None:
                return
            if time.monotonic() - self._heard_at <= SILENCE_SEC:
                v, w = self._direction
                self._publish(v * self.max_speed, w * self.max_turn)
            else:
                self.stop()

    def _publish(self, v: float, w: float) -> None:
        if self.node is None or not node_exists(self.node):
            return
        message = self._msg_type()
        if hasattr(message, 'header'):
            message.header.stamp = self.node.get_clock().now().to_msg()
        twist = getattr(message, 'twist', message)
        twist.linear.x, twist.angular.z = v, w
        self._publisher.publish(message)
        self.published, self.count = (v, w), self.count + 1
        self._listeners = self._publisher.get_subscription_count()


def _teleops() -> list[Teleop]:
    """Return the live teleops that have a node."""
    found = [view for view in live_views() if isinstance(view, Teleop)]
    return [view for view in found if view.node is not None and node_exists(view.node)]


def _message_class(stamped: bool) -> type:
    from geometry_msgs.msg import Twist, TwistStamped

    found: type = TwistStamped if stamped else Twist
    return found


def teleop(
    *,
    topic: str = 'cmd_vel',
    namespace: str = '',
    name: str = 'teleop',
    max_speed: float = BURGER.limits.v,
    max_turn: float = BURGER.limits.w,
    stamped: bool = False,
) -> Teleop:
    """Drive a robot with keys, mouse or touch.

    A node publishes `geometry_msgs/msg/Twist` ten times a second while a key is held. The robot
    stops when the key is released, when the page loses focus, and when the page is unreachable.

    Args:
        topic: Topic of the commands.
        namespace: One of several robots: `'robot1'` makes it `/robot1/cmd_vel`.
        name: Name of the node.
        max_speed: Full speed, m/s.
        max_turn: Full turning rate, rad/s.
        stamped: Publish `geometry_msgs/msg/TwistStamped` instead, as the TurtleBot3 packages of
            Jazzy expect by default, on the robot and in Gazebo.

    Returns:
        Keys and a pad in a cell. `.close()` ends it.

    Raises:
        LabError: A speed is not a positive number.
    """
    return Teleop(
        topic=topic,
        namespace=namespace,
        name=name,
        max_speed=max_speed,
        max_turn=max_turn,
        stamped=stamped,
    )
