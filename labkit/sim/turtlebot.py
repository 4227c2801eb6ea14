"""The simulated robot as a ROS node, with the topics of a TurtleBot3 Burger.

Names, types, frames and QoS are those of the real robot, so programs for this node run there
unchanged. Sources: ROBOTIS-GIT/turtlebot3, turtlebot3_node: src/turtlebot3.cpp, and
include/turtlebot3_node/sensors/sensors.hpp (KeepLast(10), reliable); ROBOTIS-GIT/
hls_lfcd_lds_driver, src/hlds_laser_publisher.cpp (SensorDataQoS).

Missing are `/magnetic_field`, and `/sensor_state`, whose type is ROBOTIS's own. `/tf` and
`/tf_static` are there once somebody wants them: no wheel has their type, so it is built first. So
is `/robot_description`, which on the real one is robot_state_publisher's.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, cast

import rclpy.utilities
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.clock import ROSClock
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.timer import Timer
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import BatteryState, CameraInfo, Image, Imu, JointState, LaserScan
from std_msgs.msg import Float64, String
from std_srvs.srv import Empty

from labkit.background.runtime import runtime
from labkit.errors import LabError
from labkit.packages.built_types import is_loaded, is_ready
from labkit.rosgraph.endpoints import publishers
from labkit.rosgraph.interfaces import type_name
from labkit.sim.burger_messages import (
    battery_message,
    camera_info_message,
    image_message,
    imu_message,
    joint_state_message,
    odometry_message,
    scan_message,
    time_message,
    truth_message,
)
from labkit.sim.camera import PI_CAMERA
from labkit.sim.command_timeout import COMMAND_TIMEOUT, TIMED_OUT_TOPIC, timed_out_words
from labkit.sim.kinematics import Pose, Twist2
from labkit.sim.pace import Beat, Stopwatch
from labkit.sim.parts import footprint, static_parts, urdf, wheel_parts
from labkit.sim.radio import Radio
from labkit.sim.simulator import Simulator
from labkit.sim.world import Contact, Wall, World

if TYPE_CHECKING:
    from labkit.sim.physics.mujoco_world import PhysicsWorld

__all__ = ['ODOM_RATE', 'TRUTH_TOPIC', 'Turtlebot']

# Rate of /odom, /joint_states, /imu and /battery_state in simulated time, Hz. The real robot also
# publishes them together, at 20 Hz.
ODOM_RATE = 30.0
QUEUE_DEPTH = 10
# Where the robot is, as nobody but a simulator knows. Name and type are those of the simulator
# Stage, and fake_localization subscribes to it. Source: ros-simulation/stage_ros,
# src/stageros.cpp; docs.ros.org/en/api/fake_localization.
TRUTH_TOPIC = 'base_pose_ground_truth'
# Queue depth of images, as in the driver of the real camera (camera_ros): only the newest is of
# use.
PICTURES = 1
# The type of /tf and /tf_static, and the queue depth of tf2_ros.
TF_TYPE = 'tf2_msgs/msg/TFMessage'
TF_DEPTH = 100
# Beyond this speed rclpy can't keep up with the messages, simulated seconds per second.
MAX_SPEED = 100.0
# Shortest timer period, s: when time runs fast, a call does several rounds.
SHORTEST_PERIOD = 0.004
# Most time that is made up for after the whole machine has paused, s.
MAX_LAG_SEC = 0.25


class Turtlebot(Node):
    """A simulated TurtleBot3 Burger on real topics.

    It subscribes to `cmd_vel` (geometry_msgs/msg/Twist) and publishes `odom`
    (nav_msgs/msg/Odometry) and `joint_states` (sensor_msgs/msg/JointState) at 30 Hz, and `scan`
    (sensor_msgs/msg/LaserScan) at 5 Hz. If anyone subscribes, it publishes `imu`
    (sensor_msgs/msg/Imu) and `battery_state` (sensor_msgs/msg/BatteryState) at 30 Hz; the battery
    is a plain model, which falls from 100 % to 0 % in 2.5 h of simulated time. Its camera, a
    Raspberry Pi camera v2 that looks ahead, publishes `camera/image_raw` (sensor_msgs/msg/Image:
    rgb8, 320 by 240 pixels, 62.2 degrees wide) and `camera/camera_info`
    (sensor_msgs/msg/CameraInfo) at 10 Hz, if anyone subscribes. As soon as this process has
    imported the type tf2_msgs/msg/TFMessage, or anybody subscribes to them, `/tf` says at 30 Hz
    where odometry has the robot and how its wheels are turned, and `/tf_static` where its other
    parts are. What it looks like, in URDF, is on `robot_description` (std_msgs/msg/String) as soon
    as anybody subscribes. The robot stops when commands stop coming, and when it touches a wall.
    The frame `odom` has the origin of the world, wherever the robot starts.

    It is perfect unless it is told to be as imperfect as a real one, by `drift`, `slip`, `noise`,
    `latency` and `loss`. Then it also publishes `base_pose_ground_truth` (nav_msgs/msg/Odometry)
    at 30 Hz if odometry may be wrong or late: the true pose, in the frame `map`, whose origin is
    that of the world, too. So it does with `physics`, with height and tilt; and then the service
    `reset_world` (std_srvs/srv/Empty) puts it, and the things in its world, back to where they
    began.

    Time can pass in three ways. By default it is real time. With `speed` it runs faster or slower,
    and `/clock` publishes it for nodes with the parameter `use_sim_time`. With `lockstep` it
    stands still until a command comes, and then advances by that many seconds: the same commands
    give the same numbers, however busy the machine is.

    Args:
        name: The node's name.
        namespace: One of several robots: `namespace='robot1'` gives `/robot1/cmd_vel` and so on.
        physics: Whether it has motors and a weight, in a world in which things are pushed, slip
            and tip over. It needs MuJoCo: `python3 -m labkit physics` installs it.
        world: The surroundings, `playground()` by default; with physics `yard()`, or a
            `PhysicsWorld`. Robots in the same world see each other.
        x: Start position, m.
        y: Start position, m.
        yaw: Start heading, rad.
        speed: Simulated seconds per second.
        lockstep: Simulated seconds per command; None if time passes by itself.
        command_timeout: Time without a command after which it stops, s. With None it keeps its
            last velocity until the next command, or a wall, as a real TurtleBot3 does on ROS 2
            (read in turtlebot3_node, branch jazzy, and the firmware, ROBOTIS-GIT/OpenCR, branch
            master). In lock-step there is none.
        drift: Odometry error: difference of the wheels' radii relative to their mean. It bends
            the way that odometry tells, always to the same side.
        slip: Odometry error: by how much each wheel turns too far on average, relative to its
            way. How much it is at the moment is random, and another number for each wheel. After
            s metres the standard deviation of the way of a wheel is slip * sqrt(0.1 s) m.
        noise: Standard deviation of a measured range, m. ROBOTIS's model of the robot for Gazebo
            has 0.01; the data sheet of the real sensor, the LDS-02, has an accuracy of 0.01 m
            below 0.3 m, and of 3 % up to 6 m.
        latency: Delay of a message, s. Each takes between half and one and a half of it, in whole
            rounds of 30 Hz, and keeps the stamp of the moment of measurement. In lock-step the
            time of a message is that of a command.
        loss: Probability that a message is lost. Neither `/clock`, `/tf_static` nor the true pose
            are ever lost or late. In lock-step, who sends a command for each `/odom` waits for
            ever for one that is lost.
        seed: Seed of slip, noise, latency and loss: the same seed gives the same numbers.
        stamped: Whether it takes `geometry_msgs/msg/TwistStamped` instead of `Twist`, as the
            TurtleBot3 packages of Jazzy do by default.
        odometry: Whether it says where it is: on `/odom`, and `base_footprint` in `odom` on `/tf`.
            If not, its wheels alone tell: so it is before the driver of a robot is written.
        scan_nothing: Value of a beam without a measurement: inf, as REP 117 has it (-inf if
            something is too near), or 0.0 in both cases, as on a real TurtleBot3.
        use_sim_time: Whether to follow the `/clock` of another node, such as a robot with `speed`.

    Attributes:
        simulator: The robot itself, without ROS.

    Raises:
        LabError: An argument is invalid, or there is no room at the start.
    """

    # Services cost time at every wake-up, and it has no parameters to set.
    _has_services = False

    def __init__(
        self,
        *,
        name: str = 'turtlebot',
        namespace: str = '',
        physics: bool = False,
        world: World | PhysicsWorld | None = None,
        x: float = 0.0,
        y: float = 0.0,
        yaw: float = 0.0,
        speed: float = 1.0,
        lockstep: float | None = None,
        command_timeout: float | None = COMMAND_TIMEOUT,
        drift: float = 0.0,
        slip: float = 0.0,
        noise: float = 0.0,
        latency: float = 0.0,
        loss: float = 0.0,
        seed: int = 0,
        stamped: bool = False,
        odometry: bool = True,
        scan_nothing: float = math.inf,
        use_sim_time: bool = False,
    ) -> None:
        _check_time(speed, lockstep, use_sim_time)
        space = namespace.strip('/')
        self.simulator: Simulator = _simulator_class(physics, world)(
            world,  # type: ignore[arg-type]
            start=Pose(x, y, yaw),
            # In lock-step a command is valid for its step, however long that is.
            command_timeout=command_timeout if lockstep is None else None,
            drift=drift,
            slip=slip,
            noise=noise,
            seed=seed,
            scan_nothing=scan_nothing,
            name=f'{space}/{name}',
        )
        self._radio = Radio(latency, loss, seed, early=(lockstep or 1 / ODOM_RATE) / 2)
        if not rclpy.utilities.ok():
            runtime.start()
        overrides = {
            'use_sim_time': use_sim_time,
            'start_type_description_service': self._has_services,
        }
        super().__init__(
            name,
            namespace=namespace,
            parameter_overrides=[
                Parameter(key, value=value)  # type: ignore[no-untyped-call]
                for key, value in overrides.items()
            ],
            start_parameter_services=self._has_services,
        )
        # Arguments of the program may have changed it.
        space = self.get_namespace().strip('/')
        self._prefix = f'{space}/' if space else ''
        self._lock = threading.RLock()
        early = 0.5 / ODOM_RATE
        self._scan_beat = Beat(1 / self.simulator.robot.scan_rate, early)
        # However fast time runs, the number of images per real second stays the same.
        self._camera_beat = Beat(max(1.0, speed) / PI_CAMERA.rate, early)
        self._due_rounds = 0.0
        self._speed = speed
        self._warned: set[str] = set()
        self._reported = 0
        self._lockstep = lockstep
        self._clock_publisher = None
        if lockstep is not None or speed != 1.0:
            self._clock_publisher = self.create_publisher(Clock, '/clock', QUEUE_DEPTH)
        self._open_topics(TwistStamped if stamped else Twist, odometry)
        self._stopwatch = Stopwatch(cast(ROSClock, self.get_clock()))
        self._timer: Timer | None = None
        if lockstep is None:
            self._start_timer()

    def _open_topics(self, command_type: type[Twist | TwistStamped], odometry: bool) -> None:
        self._odom: Any = None
        if odometry:
            on_join = self._on_join(self._publish_odometry)
            self._odom = self.create_publisher(
                Odometry, 'odom', QUEUE_DEPTH, event_callbacks=on_join
            )
        self._scan = self.create_publisher(
            LaserScan,
            'scan',
            qos_profile_sensor_data,
            event_callbacks=self._on_join(self._publish_scan),
        )
        self._joints = self.create_publisher(JointState, 'joint_states', QUEUE_DEPTH)
        self._imu = self.create_publisher(Imu, 'imu', QUEUE_DEPTH)
        self._battery = self.create_publisher(BatteryState, 'battery_state', QUEUE_DEPTH)
        self._image = self.create_publisher(Image, 'camera/image_raw', PICTURES)
        self._camera_info = self.create_publisher(CameraInfo, 'camera/camera_info', PICTURES)
        self._frames: Any = None
        self._open_frames()
        self._description: Any = None
        self._open_description()
        latched = _latched()
        self._truth: Any = None
        self._open_truth()
        self._timed_out = self.create_publisher(Float64, TIMED_OUT_TOPIC, latched)
        self._said_timed_out: bool | None = None
        self._say_timed_out()
        self._commands = self.create_subscription(
            command_type, 'cmd_vel', self._on_command, QUEUE_DEPTH
        )
        if self.simulator.has_physics:
            self._start = self.simulator.pose
            self.create_service(Empty, 'reset_world', self._on_reset)

    def _open_truth(self) -> None:
        """Begin to tell the true pose, if odometry may not be that."""
        simulator = self.simulator
        imperfect = simulator.drift or simulator.slip or not self._radio.is_perfect
        if imperfect or simulator.has_physics:
            on_join = self._on_join(self._publish_truth)
            self._truth = self.create_publisher(
                Odometry, TRUTH_TOPIC, QUEUE_DEPTH, event_callbacks=on_join
            )

    def _on_join(self, publish: Callable[[], None]) -> PublisherEventCallbacks | None:
        # In lock-step nothing is published before the first command, yet a controller may need to
        # know the pose before it can send one. So new subscribers get a message at once.
        if self._lockstep is None:
            return None

        def matched(info: Any) -> None:
            if info.total_count_change > 0:  # a new subscriber, even if another has left meanwhile
                publish()

        return PublisherEventCallbacks(matched=matched)

    # -- for cells and checks -------------------------------------------------------------------

    @property
    def pose(self) -> Pose:
        """The true pose. A program for a robot can't know it: use `/odom`."""
        return self.simulator.pose

    @property
    def twist(self) -> Twist2:
        """The true velocity."""
        return self.simulator.twist

    @property
    def collisions(self) -> list[Contact]:
        """Contacts the robot has driven into since it was placed."""
        return list(self.simulator.collisions)

    @property
    def timed_out(self) -> bool:
        """Whether it stands, or brakes, because no command came for its command timeout."""
        return self.simulator.timed_out

    def _labkit_state(self) -> tuple[str, str]:
        """Return how long it obeys a command, and why it stands: see `state_of`."""
        limit = self.simulator.command_timeout
        always = f'stops {limit:g} s after the last command'
        if self._lockstep is not None:
            always = ''
        elif limit == math.inf:
            always = 'keeps its last velocity'
        return always, f'stands: {timed_out_words(limit)}' * self.timed_out

    def place(self, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> None:
        """Move the robot to a pose, at rest, and `restart` its timers. Its odometry agrees.

        Its motion from there depends only on the commands and their times, not on earlier motion.
        Only simulated time goes on.

        Args:
            x: m.
            y: m.
            yaw: rad.

        Raises:
            LabError: The pose is outside the room, too near to a wall or a post, or not finite.
        """
        with self._lock:
            self.simulator.place((x, y, yaw))
            self._reported = 0
            self.restart()

    def enter(self, world: PhysicsWorld, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> None:
        """Take a robot with physics out of its world, and `place` it in another one.

        Args:
            world: The other one.
            x: m.
            y: m.
            yaw: rad.

        Raises:
            LabError: The robot has no physics, or as for `place`.
        """
        if not self.simulator.has_physics:
            raise _needs_physics(world)
        with self._lock:
            self.simulator.enter(world, (x, y, yaw))  # type: ignore[call-arg, arg-type]
            self.place(x, y, yaw)

    def restart(self) -> None:
        """Restart the timers: the next messages, with a scan, come a full period from now.

        The robot does not move for the time since the last period. Its speed and its command stay.
        """
        with self._lock:
            for beat in (self._scan_beat, self._camera_beat):
                beat.restart(self.simulator.time)
            self._due_rounds = 0.0
            self._radio.restart()
            self._stopwatch.restart()
            if self._timer is not None:
                # Not `reset`: that keeps the time of the last call, and if this is in the future,
                # since the clock was set back, the next step of the clock would shift the timer.
                self.destroy_timer(self._timer)
                self._start_timer()

    def destroy_node(self) -> None:
        """Destroy the node, and remove the robot from its world."""
        self._timer = None
        self.simulator.close()
        super().destroy_node()  # type: ignore[no-untyped-call]

    # -- time -----------------------------------------------------------------------------------

    def _start_timer(self) -> None:
        if self._speed == 1.0:
            self._timer = self.create_timer(1 / ODOM_RATE, self._on_timer)
            return
        period = max(1 / (ODOM_RATE * self._speed), SHORTEST_PERIOD)
        self._timer = self.create_timer(period, self._on_fast_timer)

    def _on_timer(self) -> None:
        """Real time: catch up with the clock, then publish."""
        with self._lock:
            self._step(self._stopwatch.passed())
            self._publish_all()

    def _on_fast_timer(self) -> None:
        """Simulated time: steps of equal length, so the numbers don't depend on the machine."""
        with self._lock:
            # By the clock, not by the calls: a late timer skips calls.
            passed = min(self._stopwatch.passed(), MAX_LAG_SEC)
            self._due_rounds += passed * self._speed * ODOM_RATE
            # The tolerance keeps a step from being late because 0.1 * 10 is not quite 1.
            while self._due_rounds > 1 - 1e-9:
                self._due_rounds -= 1
                self._step(1 / ODOM_RATE)
                self._publish_all()

    def _step(self, seconds: float) -> None:
        self.simulator.step(seconds)
        new = self.simulator.collisions[self._reported :]
        self._reported += len(new)
        for contact in new:
            thing = 'a wall' if isinstance(contact.thing, Wall) else 'an obstacle'
            place = f'x={contact.x:.2f} m, y={contact.y:.2f} m'
            if self.simulator.has_physics:
                self._warn(f'Bumped into {thing} at {place}.')
                continue
            self._warn(
                f'Bumped into {thing} at {place}, and stopped. Back off, or turn on the spot, to '
                'go on.'
            )
        if not self.simulator.tipped_over:
            self._warned.discard('tipped')
        else:
            self._warn_once(
                'tipped', 'Tipped over. The service reset_world puts it back on its wheels.'
            )
        if self._lockstep is None and self.simulator.real_time_factor < self._speed:
            self._warn_once(
                'slow',
                f'This machine computes {self.simulator.real_time_factor:.2g} s of the world in a '
                f'second, and {self._speed:g} s are wanted: the world falls behind.',
            )

    def _on_reset(self, request: Any, response: Any) -> Any:
        with self._lock:
            self.simulator.reset_world()
            self.place(*self._start)
        return response

    # -- commands -------------------------------------------------------------------------------

    def _on_command(self, message: Twist | TwistStamped) -> None:
        command = message.twist if isinstance(message, TwistStamped) else message
        with self._lock:
            if self._clock_publisher is None:
                # The previous command is valid until now.
                self._step(self._stopwatch.passed())
            self._set_command(command)
            if self._lockstep is not None:
                self._step(self._lockstep)
                self._publish_all()

    def _set_command(self, message: Twist) -> None:
        v, w = message.linear.x, message.angular.z
        others = {
            'linear.y': message.linear.y,
            'linear.z': message.linear.z,
            'angular.x': message.angular.x,
            'angular.y': message.angular.y,
        }
        # One invalid number makes the whole command doubtful.
        sensible = all(math.isfinite(value) for value in others.values())
        if not self.simulator.command(v if sensible else math.nan, w):
            fields = {'linear.x': v, **others, 'angular.z': w}
            text = ', '.join(f'{name}={value!r}' for name, value in fields.items() if value)
            self._warn_once('refused', f'Refused a command without sense: {text}. Stopping.')
            return
        self._warned.discard('refused')
        ignored = ', '.join(name for name, value in others.items() if value)
        if ignored:
            self._warn_once(
                'ignored',
                f"Can't obey {ignored} of /cmd_vel: a robot with two wheels drives along linear.x "
                'and turns about angular.z.',
            )
        limits = self.simulator.robot.limits
        if abs(v) > limits.v or abs(w) > limits.w:
            self._warn_once(
                'cut',
                f'The robot drives at most {limits.v} m/s and turns at most {limits.w} rad/s. '
                'Commands beyond that are cut.',
            )

    def _warn_of_other_commands(self) -> None:
        """Say which commands can't be heard: those of another type reach nobody."""
        here = type_name(self._commands.msg_type)
        found = publishers(self, self._commands.topic_name)
        others = {end.node: end.msg_type for end in found if end.is_known and end.msg_type != here}
        for name, msg_type in others.items():
            pair = ('geometry_msgs/msg/Twist', 'geometry_msgs/msg/TwistStamped')
            todo = f' Make the robot with stamped={msg_type == pair[1]}.' * (msg_type in pair)
            self._warn_once(
                f'{name} {msg_type}',
                f"Can't hear {name} on {self._commands.topic_name}: it publishes {msg_type}, and "
                f'this robot takes {here}.{todo}',
            )

    def _warn_once(self, what: str, text: str) -> None:
        """Warn, but not twice about the same: commands come ten times a second."""
        if what not in self._warned:
            self._warned.add(what)
            self._warn(text)

    def _warn(self, text: str) -> None:
        self.get_logger().warning(text)  # type: ignore[no-untyped-call]

    # -- messages -------------------------------------------------------------------------------

    def _publish_all(self) -> None:
        if self._clock_publisher is not None:
            self._clock_publisher.publish(Clock(clock=self._stamp()))
        self._say_timed_out()
        # One stamp for all: what a sensor has seen can be looked up in the frames of that moment.
        stamp = self._stamp()
        self._publish_truth(stamp)
        self._publish_odometry(stamp)
        self._publish_frames(stamp)
        # These rarely have subscribers; making them would be a waste.
        if self._joints.get_subscription_count():
            self._send(self._joints, joint_state_message(self.simulator, stamp, self._prefix))
        if self._imu.get_subscription_count():
            self._send(self._imu, imu_message(self.simulator, stamp, self._prefix))
        if self._battery.get_subscription_count():
            self._send(self._battery, battery_message(self.simulator, stamp))
        if self._scan_beat.is_due(self.simulator.time):
            self._publish_scan(stamp)
            self._warn_of_other_commands()
            self._open_frames()
            self._open_description()
        if self._camera_beat.is_due(self.simulator.time):
            self._publish_picture()
        self._radio.deliver(self.simulator.time)

    def _send(self, publisher: Any, message: Any, *, at_once: bool = False) -> None:
        if at_once:
            # It is for one that has just joined, in lock-step: no time passes until it answers.
            publisher.publish(message)
        else:
            self._radio.send(publisher, message, self.simulator.time)

    def _say_timed_out(self) -> None:
        if self.timed_out != self._said_timed_out:
            self._said_timed_out = self.timed_out
            limit = self.simulator.command_timeout if self.timed_out else 0.0
            self._timed_out.publish(Float64(data=limit))

    def _publish_odometry(self, stamp: Time | None = None) -> None:
        if self._odom is not None:
            message = odometry_message(self.simulator, stamp or self._stamp(), self._prefix)
            self._send(self._odom, message, at_once=stamp is None)

    def _publish_truth(self, stamp: Time | None = None) -> None:
        if self._truth is not None:
            message = truth_message(self.simulator, stamp or self._stamp(), self._prefix)
            self._truth.publish(message)

    def _publish_scan(self, stamp: Time | None = None) -> None:
        message = scan_message(self.simulator, stamp or self._stamp(), self._prefix)
        self._send(self._scan, message, at_once=stamp is None)

    def _open_frames(self) -> None:
        """Begin to say where the parts are, if somebody wants that and the type is there."""
        if self._frames is not None:
            return
        heard = self.count_subscribers('/tf') or self.count_subscribers('/tf_static')
        if not is_loaded(TF_TYPE) and not (heard and is_ready(TF_TYPE)):
            if heard:
                self._warn_once(
                    'frames',
                    f"Can't say on /tf where my parts are: the type {TF_TYPE} is not there. This "
                    'builds it, once: from tf2_msgs.msg import TFMessage',
                )
            return
        from tf2_msgs.msg import TFMessage

        static = self.create_publisher(TFMessage, '/tf_static', _latched())
        static.publish(TFMessage(transforms=static_parts(self._stamp(), self._prefix)))
        on_join = self._on_join(self._publish_frames)
        self._frames = self.create_publisher(TFMessage, '/tf', TF_DEPTH, event_callbacks=on_join)

    def _open_description(self) -> None:
        """Say what the robot looks like, once, if somebody wants that."""
        if self._description is None and self.count_subscribers('robot_description'):
            self._description = self.create_publisher(String, 'robot_description', _latched())
            self._description.publish(String(data=urdf(self._prefix)))

    def _publish_frames(self, stamp: Time | None = None) -> None:
        if self._frames is not None:
            stamp = stamp or self._stamp()
            parts = wheel_parts(self.simulator, stamp, self._prefix)
            if self._odom is not None:
                parts = [footprint(self.simulator, stamp, self._prefix), *parts]
            message = self._frames.msg_type(transforms=parts)
            self._send(self._frames, message, at_once=stamp is None)

    def _publish_picture(self) -> None:
        stamp = self._stamp()
        if self._image.get_subscription_count():
            self._send(self._image, image_message(self.simulator, stamp, self._prefix))
        if self._camera_info.get_subscription_count():
            self._send(self._camera_info, camera_info_message(stamp, self._prefix))

    def _stamp(self) -> Any:
        if self._clock_publisher is None:
            return self.get_clock().now().to_msg()
        return time_message(self.simulator.time)


def _simulator_class(physics: bool, world: World | PhysicsWorld | None) -> type[Simulator]:
    if not physics:
        if world is not None and not isinstance(world, World):
            raise _needs_physics(world)
        return Simulator
    from labkit.sim.physics.physics_robot import PhysicsSimulator

    return PhysicsSimulator


def _needs_physics(world: PhysicsWorld) -> LabError:
    return LabError(
        f'The world {world!r} is one with physics, and this robot has none.',
        todo='lab.Turtlebot(physics=True, world=...)',
    )


def _latched() -> QoSProfile:
    return QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # type: ignore[no-untyped-call]


def _check_time(speed: float, lockstep: float | None, use_sim_time: bool) -> None:
    if not 0 < speed <= MAX_SPEED:
        raise LabError(f'speed must be more than 0, up to {MAX_SPEED}, but it is {speed!r}.')
    if lockstep is not None and not 0 < lockstep <= 60:
        raise LabError(f'lockstep must be more than 0 s, up to 60 s, but it is {lockstep!r}.')
    if [speed != 1.0, lockstep is not None, use_sim_time].count(True) > 1:
        raise LabError(
            f'speed={speed!r}, lockstep={lockstep!r} and use_sim_time={use_sim_time!r} exclude '
            'each other: each is another way for time to pass.',
            todo='Give one of them only.',
        )
