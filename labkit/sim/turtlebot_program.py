"""The robot as a program of its own: `ros2 run labkit turtlebot`, or a node of a launch file.

Robots that run so stand in one world: each says where it is on a hidden topic, and is a post in
the worlds of the others. The parameters `x`, `y` and `yaw` are its start, m and rad;
`command_timeout` is the time without a command after which it stops, s, or 0 if it keeps its last
velocity; `drift`, `slip`, `noise`, `latency`, `loss` and `seed` make it as imperfect as those of
`lab.Turtlebot`.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from geometry_msgs.msg import PointStamped
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.event_handler import SubscriptionEventCallbacks

from labkit.errors import LabError
from labkit.programs.program import spin_until_interrupted
from labkit.sim.command_timeout import COMMAND_TIMEOUT
from labkit.sim.radio import Radio
from labkit.sim.simulator import Simulator
from labkit.sim.turtlebot import ODOM_RATE, QUEUE_DEPTH, Turtlebot
from labkit.sim.world import Post

__all__ = ['TurtlebotProgram', 'main']

PLACES = '/_turtlebot_places'


class TurtlebotProgram(Turtlebot):
    """A robot that shares its world with those of other processes."""

    _has_services = True

    def __init__(self) -> None:
        super().__init__()
        self._name = self.get_fully_qualified_name()
        self.simulator.close()
        # Parameters are known only now. None can't be one.
        seed = int(self._number('seed'))
        self.simulator = Simulator(
            start=(self._number('x'), self._number('y'), self._number('yaw')),
            command_timeout=self._number('command_timeout', COMMAND_TIMEOUT) or None,
            drift=self._number('drift'),
            slip=self._number('slip'),
            noise=self._number('noise'),
            seed=seed,
            name=self._name,
        )
        latency, loss = self._number('latency'), self._number('loss')
        self._radio = Radio(latency, loss, seed, early=0.5 / ODOM_RATE)
        self._open_truth()
        self.restart()
        self._place = self.create_publisher(PointStamped, PLACES, QUEUE_DEPTH)
        self.create_subscription(
            PointStamped,
            PLACES,
            self._on_place,
            QUEUE_DEPTH,
            event_callbacks=SubscriptionEventCallbacks(matched=self._on_matched),
        )

    def _number(self, name: str, default: float = 0.0) -> float:
        # Of any type, since a launch file may say 1 as well as 1.0.
        anything = ParameterDescriptor(dynamic_typing=True)
        value = self.declare_parameter(name, default, anything).value
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise LabError(f'The parameter {name} is a number, but it is {value!r}.')
        return float(value)

    def _publish_all(self) -> None:
        super()._publish_all()
        place = PointStamped()
        place.header.frame_id = self._name
        place.point.x, place.point.y, _ = self.pose
        self._place.publish(place)

    def _on_place(self, place: PointStamped) -> None:
        name = place.header.frame_id
        if name != self._name:
            radius = self.simulator.robot.radius
            self.simulator.world.robots[name] = Post(place.point.x, place.point.y, radius)

    def _on_matched(self, info: Any) -> None:
        if info.current_count_change < 0:
            # One has gone. The others say again where they are.
            robots = self.simulator.world.robots
            for name in robots.keys() - {self._name}:
                del robots[name]


def main() -> None:
    """Run a robot until it is interrupted."""
    rclpy.init(args=sys.argv)
    try:
        robot = TurtlebotProgram()
    except LabError as error:
        rclpy.shutdown()
        sys.exit(str(error))
    spin_until_interrupted(robot)


if __name__ == '__main__':
    main()
