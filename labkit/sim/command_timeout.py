"""The command timeout: how long a robot obeys its last command, and what it says of that.

A TurtleBot3 on ROS 2 has none: it keeps its last velocity as long as its own node runs. Sources:
ROBOTIS-GIT/turtlebot3, branch jazzy, turtlebot3_node/src/turtlebot3.cpp: `cmd_vel_callback` writes
a velocity when a command comes, nothing else does, and `heartbeat_timer` beats every 100 ms,
commands or none. ROBOTIS-GIT/OpenCR, branch master, arduino/opencr_arduino/opencr/libraries/
turtlebot3_ros2/src/turtlebot3/turtlebot3.cpp: the firmware sets the velocity to zero only if that
beat has been missing for HEARTBEAT_TIMEOUT_MS, 500 ms.
"""

from __future__ import annotations

import math

from labkit.errors import LabError

__all__ = ['COMMAND_TIMEOUT', 'TIMED_OUT_TOPIC', 'as_limit', 'timed_out_words']

# Time for which a command is valid, s. Source: ROBOTIS-GIT/turtlebot3_simulations,
# turtlebot3_fake_node/src/turtlebot3_fake_node.cpp, cmd_vel_timeout_.
COMMAND_TIMEOUT = 1.0
# Beside a robot's other topics: the timeout that has stopped it, s, or 0 if none has
# (std_msgs/msg/Float64, transient local). Views in any process know from it why a robot stands.
TIMED_OUT_TOPIC = '_command_timed_out'


def as_limit(command_timeout: float | None) -> float:
    """Return a command timeout as a number, s: inf for None.

    Raises:
        LabError: It is not more than 0.
    """
    limit = math.inf if command_timeout is None else command_timeout
    if not limit > 0:
        raise LabError(
            'command_timeout must be more than 0 s, or None for a robot that keeps its last '
            f'velocity, but it is {command_timeout!r}.'
        )
    return limit


def timed_out_words(seconds: float) -> str:
    """Return why a robot stands that its command timeout, s, has stopped."""
    return f'no command for {seconds:g} s; its time limit for commands has stopped it'
