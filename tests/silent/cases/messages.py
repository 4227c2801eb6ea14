"""Content of messages, see `labkit.silent.message_faults`."""


def _fields(kind: str, wrong: str, right: str, make: str = 'stamped({kind})') -> tuple[str, str]:
    """Return two cells that set the fields of a message of a kind, and say it."""
    made = f'm = {make.format(kind=kind)}\n'
    return f'{made}{wrong}\nsay(m)', f'{made}{right}\nsay(m)'


_MARKER = 'm.type = m.CUBE; m.scale.x = m.scale.y = m.scale.z = 1.0; '
_JOINTS = "m.name = ['a', 'b']; m.position = "
_POINTS = (
    "m = JointTrajectory(joint_names=['a', 'b'])\n"
    'for sec, positions in {points}:\n'
    '    p = JointTrajectoryPoint(positions=positions); p.time_from_start.sec = sec\n'
    '    m.points.append(p)\n'
    'say(m)'
)
_IMAGE = "m.width, m.height, m.encoding = 4, 2, 'rgb8'; "
_ONE = '[1.0, 2.0]'

CASES = {
    'messages.quaternion-zero': _fields(
        'PoseStamped', 'm.pose.orientation.w = 0.0', 'm.pose.orientation.w = 1.0'
    ),
    'messages.quaternion-length': _fields(
        'PoseStamped', 'm.pose.orientation.z = 1.57', 'm.pose.orientation.z = 0.01'
    ),
    'messages.nan': _fields('Twist', 'm.linear.x = math.nan', 'm.linear.x = 0.1', make='{kind}()'),
    'messages.infinite': (
        'm = Twist(); m.linear.x = math.inf; say(m)',
        'say(scan(ranges=[math.inf] * 5))',
    ),
    'messages.frame-empty': (
        "m = stamped(PoseStamped); m.header.frame_id = ''; say(m)",
        "m = stamped(JointState); m.header.frame_id = ''; say(m)",
    ),
    'messages.frame-slash': _fields(
        'PoseStamped', "m.header.frame_id = '/map'", "m.header.frame_id = 'robot/map'"
    ),
    'messages.stamp-zero': (
        'm = stamped(Odometry); m.header.stamp.sec = m.header.stamp.nanosec = 0; say(m)',
        'm = stamped(PoseStamped); m.header.stamp.sec = m.header.stamp.nanosec = 0; say(m)',
    ),
    'messages.degrees': _fields('Twist', 'm.angular.z = 90.0', 'm.angular.z = 1.57', '{kind}()'),
    'messages.millimetres': _fields(
        'Twist', 'm.linear.x = 200.0', 'm.linear.x = 0.2', make='{kind}()'
    ),
    'messages.percent': _fields('BatteryState', 'm.percentage = 80.0', 'm.percentage = 0.8'),
    'messages.latitude': _fields('NavSatFix', 'm.latitude = 116.4', 'm.longitude = 116.4'),
    'messages.image-size': _fields(
        'Image',
        f'{_IMAGE}m.step = 12; m.data = bytes(12)',
        f'{_IMAGE}m.step = 12; m.data = bytes(24)',
    ),
    'messages.image-encoding': _fields(
        'Image',
        f'{_IMAGE}m.step = 4; m.data = bytes(8)',
        f'{_IMAGE}m.step = 16; m.data = bytes(32)',
    ),
    'messages.scan-count': ('say(scan(ranges=[1.0] * 9))', 'say(scan(ranges=[1.0] * 4))'),
    'messages.scan-range': ('say(scan(range_max=0.0))', 'say(scan(range_min=0.0))'),
    'messages.intensities': (
        'say(scan(intensities=[1.0]))',
        'say(scan(intensities=[1.0] * 5))',
    ),
    'messages.grid-size': _fields(
        'OccupancyGrid',
        'm.info.width = m.info.height = 2; m.info.resolution = 0.05; m.data = [0] * 2',
        'm.info.width = m.info.height = 2; m.info.resolution = 0.05; m.data = [0] * 4',
    ),
    'messages.grid-resolution': _fields(
        'OccupancyGrid', 'm.info.resolution = 0.0', 'm.info.resolution = 0.05'
    ),
    'messages.cloud-size': _fields(
        'PointCloud2',
        'm.width, m.height, m.point_step, m.row_step, m.data = 2, 1, 12, 24, bytes(12)',
        'm.width, m.height, m.point_step, m.row_step, m.data = 2, 1, 12, 24, bytes(24)',
    ),
    'messages.joints': _fields('JointState', f'{_JOINTS}[1.0]', f'{_JOINTS}{_ONE}'),
    'messages.trajectory': (
        _POINTS.format(points='[(1, [1.0])]'),
        _POINTS.format(points=f'[(1, {_ONE})]'),
    ),
    'messages.trajectory-times': (
        _POINTS.format(points=f'[(1, {_ONE}), (1, {_ONE})]'),
        _POINTS.format(points=f'[(1, {_ONE}), (2, {_ONE})]'),
    ),
    'messages.marker-invisible': _fields('Marker', _MARKER, f'{_MARKER}m.color.a = 1.0'),
    'messages.marker-scale': _fields(
        'Marker',
        'm.type = m.CUBE; m.color.a = 1.0',
        "m.type = m.TEXT_VIEW_FACING; m.text = 'x'; m.scale.z = 1.0; m.color.a = 1.0",
    ),
    'messages.colour': _fields(
        'Marker', f'{_MARKER}m.color.a, m.color.r = 1.0, 255.0', f'{_MARKER}m.color.a = 1.0'
    ),
}
