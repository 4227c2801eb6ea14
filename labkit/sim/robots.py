"""The robots that can be simulated: dimensions and limits in SI units, each with its source."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from labkit.sim.kinematics import Twist2

__all__ = ['BURGER', 'DriveLimits', 'Robot']


class DriveLimits(NamedTuple):
    """The limits of the drive, the same in both directions.

    Attributes:
        v: Speed, m/s.
        w: Turning rate, rad/s.
        v_rate: Acceleration, m/s².
        w_rate: Angular acceleration, rad/s².
    """

    v: float
    w: float
    v_rate: float
    w_rate: float

    def clip(self, target: Twist2) -> Twist2:
        """Return a command clipped to the limits."""
        if abs(target.v) <= self.v and abs(target.w) <= self.w:
            return target
        return Twist2(
            min(max(target.v, -self.v), self.v),
            min(max(target.w, -self.w), self.w),
        )


@dataclass(frozen=True)
class Robot:
    """The dimensions of a robot.

    Attributes:
        radius: Radius of the disc around the middle of the axle that encloses the robot, m.
        wheel_radius: m.
        wheel_separation: Distance between the wheels, m.
        scan_x: Position of the laser scanner along the heading, from the middle of the axle, m.
        scan_beams: Beams per turn of the scanner; the first looks ahead, the next to its left.
        scan_rate: Turns of the scanner per second, Hz.
        range_min: Minimum range of the scanner, m.
        range_max: Maximum range of the scanner, m.
    """

    radius: float
    wheel_radius: float
    wheel_separation: float
    limits: DriveLimits
    scan_x: float
    scan_beams: int
    scan_rate: float
    range_min: float
    range_max: float


# Sources:
# - speeds: ROBOTIS e-manual, TurtleBot3, "Features > Specifications" (emanual.robotis.com):
#   0.22 m/s, 2.84 rad/s;
# - wheels: ROBOTIS-GIT/turtlebot3, turtlebot3_bringup/param/*/burger.yaml: 0.160 m, 0.033 m;
# - radius: ROBOTIS-GIT/OpenCR, turtlebot3_ros2/src/turtlebot3/turtlebot3.cpp, burger_info:
#   0.105 m;
# - accelerations: ROBOTIS-GIT/turtlebot3, turtlebot3_navigation2/param/jazzy/burger.yaml,
#   decel_lim_x 2.5 m/s² and acc_lim_theta 3.2 rad/s² (the motors' own profile is unlimited);
# - scanner LDS-01: e-manual, "Appendix > LDS-01": 360 beams of 1 degree, 0.12 m to 3.5 m,
#   300 turns a minute; its place: ROBOTIS-GIT/turtlebot3_simulations, turtlebot3_gazebo/models/
#   turtlebot3_burger/model.sdf, lidar_joint: 0.032 m behind the axle.
BURGER = Robot(
    radius=0.105,
    wheel_radius=0.033,
    wheel_separation=0.160,
    limits=DriveLimits(v=0.22, w=2.84, v_rate=2.5, w_rate=3.2),
    scan_x=-0.032,
    scan_beams=360,
    scan_rate=5.0,
    range_min=0.12,
    range_max=3.5,
)
