"""Public questions whose answer was a silent fault: where, what was wrong, what is told.

The cells are small reproductions of our own. Helpers are those of `cases/prelude.py`.
"""

from __future__ import annotations

from typing import NamedTuple

__all__ = ['QUESTIONS', 'Question']


class Question(NamedTuple):
    """A question: thread on GitHub, what was wrong, the id that is told, and a cell."""

    thread: str
    wrong: str
    told: str
    cell: str


def _best_effort(kind: str, topic: str) -> str:
    offered = 'QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)'
    return f"deaf('reader', '{topic}', {kind}); loud('sensor', '{topic}', {kind}, {offered})"


def _stamped(robot: str, driver: str) -> str:
    topic = f'{driver}/cmd_vel'
    return (
        f"deaf('{robot}', '{topic}', TwistStamped); other = other_process('{driver}')\n"
        f"ORIGINALS['create_publisher'](other, Twist, '{topic}', 10)\n"
        f"lab.wait_until(lambda: runtime.helper.count_publishers('/{topic}'), timeout_sec=20)\n"
        'all_named(3)'
    )


def _file(key: str, name: str, space: str = '') -> str:
    args = "cli_args=['--ros-args', '--params-file', 'p.yaml']"
    return (
        f"open('p.yaml', 'w').write('{key}: {{ros__parameters: {{noise: 50.0}}}}')\n"
        f"n = Node('{name}', namespace='{space}', {args}); n.declare_parameter('noise', 0.1)\n"
        'lab.spin(n)'
    )


def _scan(count: int, increment: float) -> str:
    angles = 'angle_min=-math.pi, angle_max=math.pi'
    return f"say(scan({angles}, angle_increment={increment}, ranges=[1.0] * {count}), 'scan')"


def _turned(x: float, y: float, z: float, w: float) -> str:
    values = ', '.join(f"float('{value}')" for value in (x, y, z, w))
    return (
        f'm = stamped(PoseStamped); q = m.pose.orientation; q.x, q.y, q.z, q.w = {values}\n'
        "say(m, 'pose')"
    )


def _map(asked: str, offered: str) -> str:
    return (
        f"p = loud('map_server', 'map', OccupancyGrid, QoSProfile(depth=1, {offered}))\n"
        'g = stamped(OccupancyGrid); g.info.resolution = 0.05; p.publish(g)\n'
        f"deaf('planner', 'map', OccupancyGrid, QoSProfile(depth=1, {asked}))"
    )


_LATCHED = 'durability=DurabilityPolicy.TRANSIENT_LOCAL'
_SIM = "parameter_overrides=[Parameter('use_sim_time', value=True)]"
_MARKER = 'm = stamped(Marker); m.type = m.CUBE; m.scale.x = m.scale.y = m.scale.z = 1.0; '
_NAN = float('nan')
_RATE = (
    "n = Node('base'); r = n.create_rate({hz})\n"
    'threading.Thread(target=r.sleep, daemon=True).start()\nlab.wait_until(lambda: runtime.waits)'
)
_SLOW = (
    "n = deaf('worker', 'trigger')\ndef tick(): time.sleep({seconds})\n"
    'n.create_timer(1e-3, tick); lab.wait_until(lambda: runtime.entry_of(n).took, timeout_sec=20)'
)

QUESTIONS = [
    Question(
        'ros2/teleop_twist_keyboard#16',
        'a reliable subscriber, a best effort teleop',
        'qos.reliability',
        _best_effort('Twist', 'cmd_vel'),
    ),
    Question(
        'iKrishneel/octomap_server2#7',
        'point clouds are best effort',
        'qos.reliability',
        _best_effort('PointCloud2', 'cloud_in'),
    ),
    Question(
        'iRobotEducation/create3_docs#454',
        'all sensors of the robot are best effort',
        'qos.reliability',
        _best_effort('BatteryState', 'battery_state'),
    ),
    Question(
        'micro-ROS/micro_ros_setup#236',
        'the board publishes best effort',
        'qos.reliability',
        _best_effort('String', 'microROS/pong'),
    ),
    Question(
        'turtlebot/turtlebot4#161',
        'the intensities are best effort',
        'qos.reliability',
        _best_effort('Int16', 'ir_intensity'),
    ),
    Question(
        'aws-robotics/aws-robomaker-sample-application-cloudwatch#60',
        'a depth alone asks for reliable scans',
        'qos.reliability',
        _best_effort('LaserScan', 'scan'),
    ),
    Question(
        'ros-event-camera/libcaer_driver#3',
        'the subscriber asks for a private name',
        'names.private',
        "deaf('minimal_subscriber', '~/events'); loud('renderer', 'events')",
    ),
    Question(
        'ros2/rclcpp#940',
        'simulated time without a clock',
        'time.no-clock',
        f"node('time_test', {_SIM}).create_timer(0.1, heard)",
    ),
    Question(
        'ros/joint_state_publisher#103',
        'simulated time without a simulator',
        'time.no-clock',
        f"loud('joint_state_publisher', 'joint_states', JointState, {_SIM})",
    ),
    Question(
        'ros2/ros2_documentation#4132',
        'the loop sleeps on a rate and never spins',
        'life.rate-unspun',
        _RATE.format(hz=2),
    ),
    Question(
        'PickNikRobotics/stretch_ros#25',
        'a rate without a thread that spins',
        'life.rate-unspun',
        _RATE.format(hz=15),
    ),
    Question(
        'ros-controls/gz_ros2_control#474',
        'the controller takes stamped velocities',
        'types.stamped',
        _stamped('controller', 'teleop'),
    ),
    Question(
        'ROBOTIS-GIT/turtlebot3#1134',
        'the patrol example sends plain velocities',
        'types.stamped',
        _stamped('turtlebot3_node', 'patrol'),
    ),
    Question(
        'ROBOTIS-GIT/turtlebot3#1135',
        'the bridge takes stamped velocities, the teleop sends plain ones',
        'types.stamped',
        _stamped('bridge', 'teleop_keyboard'),
    ),
    Question(
        'Ekumen-OS/andino#281',
        'since Jazzy the controller takes stamped velocities',
        'types.stamped',
        _stamped('diff_drive', 'joystick'),
    ),
    Question(
        'DataBot-Labs/hoverboard_ros2_control#12',
        'the wheels get nothing of a plain velocity',
        'types.stamped',
        _stamped('hoverboard', 'keyboard'),
    ),
    Question(
        'RobotecAI/rai#354',
        'the tool sends plain velocities',
        'types.stamped',
        _stamped('robot', 'tool'),
    ),
    Question(
        'ROBOTIS-GIT/turtlebot3#1038',
        'navigation moved to stamped velocities',
        'types.stamped',
        _stamped('nav2_robot', 'old_nav2'),
    ),
    Question(
        'manankharwar/fusioncore#134',
        'the file is for a node of another name',
        'parameters.file-node',
        _file('fusioncore', 'fusioncore_test'),
    ),
    Question(
        'AutonomyLab/create_robot#79',
        'the first line of the file must be the name of the node',
        'parameters.file-node',
        _file('ca_driver', 'create_driver'),
    ),
    Question(
        'TixiaoShan/LIO-SAM#277',
        'the nodes are called otherwise than the file says',
        'parameters.file-node',
        _file('lio_sam', 'imu_preintegration'),
    ),
    Question(
        'ros2/ros2#569',
        'the node is in a namespace, the file does not say so',
        'parameters.file-namespace',
        _file('talker', 'talker', 'talker_ns'),
    ),
    Question(
        'ros-navigation/navigation2#3376',
        'launched with a namespace, the file is without one',
        'parameters.file-namespace',
        _file('node1', 'node1', 'robot1'),
    ),
    Question(
        'ros-visualization/rviz#368',
        'alpha of the marker is 0',
        'messages.marker-invisible',
        f"{_MARKER}say(m, 'marker')",
    ),
    Question(
        'ros2/common_interfaces#130',
        'three of four fields of the colour are set',
        'messages.marker-invisible',
        f"{_MARKER}m.color.r = m.color.g = 1.0; say(m, 'marker')",
    ),
    Question(
        'rst-tu-dortmund/costmap_converter#33',
        'a marker without a frame',
        'messages.frame-empty',
        f"{_MARKER}m.color.a = 1.0; m.header.frame_id = ''; say(m, 'marker')",
    ),
    Question(
        'koide3/hdl_graph_slam#94',
        'one of the markers has an empty frame',
        'messages.frame-empty',
        "m = stamped(PoseStamped); m.header.frame_id = ''; say(m, 'nodes')",
    ),
    Question(
        'izhengfan/se2lam#44',
        'the frame begins with a slash',
        'messages.frame-slash',
        f"{_MARKER}m.color.a = 1.0; m.header.frame_id = '/se2lam/World'; say(m, 'marker')",
    ),
    Question(
        'ros2/ros2_documentation#6476',
        'a tutorial of ROS 1 had a slash in front of its frame',
        'messages.frame-slash',
        "m = stamped(PoseStamped); m.header.frame_id = '/my_frame'; say(m, 'pose')",
    ),
    Question(
        'ldrobotSensorTeam/ldlidar_stl_ros2#18',
        '456 ranges with angles for 451',
        'messages.scan-count',
        _scan(456, 0.013963),
    ),
    Question(
        'joshnewans/articubot_one#34',
        'the number of ranges changes from turn to turn',
        'messages.scan-count',
        _scan(447, 0.013963),
    ),
    Question(
        'YDLIDAR/ydlidar_ros_driver#4',
        '719 ranges with an increment for 724',
        'messages.scan-count',
        _scan(719, 0.00869043637067),
    ),
    Question(
        'ArduPilot/ardupilot#26868',
        'a rotation of four zeros',
        'messages.quaternion-zero',
        _turned(0, 0, 0, 0),
    ),
    Question(
        'ArduPilot/ardupilot#27140',
        'the default of a quaternion elsewhere is four zeros',
        'messages.quaternion-zero',
        "m = stamped(Odometry); m.pose.pose.orientation.w = 0.0; say(m, 'odom')",
    ),
    Question(
        'SmartRoboticSystems/aruco_mapping#18',
        'an orientation of NaN',
        'messages.nan',
        _turned(_NAN, _NAN, _NAN, _NAN),
    ),
    Question(
        'ankitdhall/lidar_camera_calibration#142',
        'a position of NaN',
        'messages.nan',
        "m = stamped(PoseStamped); m.pose.position.x = math.nan; say(m, 'pose')",
    ),
    Question(
        'orbbec/OrbbecSDK_ROS1#49',
        'a position that is infinite',
        'messages.infinite',
        "m = stamped(PoseStamped); m.pose.position.z = -math.inf; say(m, 'pose')",
    ),
    Question(
        'cra-ros-pkg/robot_localization#459',
        'the rotation was not normalised',
        'messages.quaternion-length',
        _turned(0.0, 0.0, 1.5, 1.0),
    ),
    Question(
        'ros2/rviz#478',
        'the map is latched, the display asks for a volatile one',
        'qos.late',
        _map('', _LATCHED),
    ),
    Question(
        'fzi-forschungszentrum-informatik/ros2_ros_bt_py#184',
        'the subscriber did not ask for what is kept',
        'qos.late',
        _map('reliability=ReliabilityPolicy.RELIABLE', _LATCHED),
    ),
    Question(
        'eProsima/Fast-DDS#2062',
        'a volatile reader comes late',
        'qos.late',
        "loud('writer', 'samples').publish(String()); deaf('reader', 'samples')",
    ),
    Question(
        'ros2/rviz#461',
        'the map is volatile, the display asks for a latched one',
        'qos.durability',
        _map(_LATCHED, ''),
    ),
    Question(
        'ros2/rclpy#1039',
        'a callback sleeps, and no other one runs',
        'time.long-callback',
        _SLOW.format(seconds=1.2),
    ),
    Question(
        'ros2/rclcpp#392',
        'a timer takes longer than its period, and a service is never served',
        'time.long-callback',
        _SLOW.format(seconds=1.05),
    ),
]
