"""Answers to `nearest`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

PUBLISH = '        self.publisher.publish(found)\n'
LOOKUP = "            transform = self.buffer.lookup_transform('odom', frame, stamp)\n"

ANSWERS = [
    wrong(
        'in the frame of the robot',
        'The point is in the frame of the robot',
        (LOOKUP, "            body = frame.replace('scanner', 'robot')\n" + LOOKUP),
        ("'odom', frame", 'body, frame'),
    ),
    wrong(
        'the robot for the scanner',
        'The scanner was taken for the robot',
        (LOOKUP, "            frame = frame.replace('scanner', 'robot')\n" + LOOKUP),
    ),
    wrong(
        'one name for the scanner',
        'The scans were heard, and no point came',
        ("'odom', frame", "'odom', 'base_scan'"),
        ('frame, stamp = scan.header.frame_id, Time', 'stamp = Time'),
    ),
    wrong(
        'now',
        'The scans were heard, and no point came',
        ('Time.from_msg(scan.header.stamp)', 'self.get_clock().now()'),
        ('from rclpy.time import Time\n', ''),
    ),
    wrong(
        'stops after five',
        'Some scans got no point',
        (PUBLISH, f"        self.count = getattr(self, 'count', 0) + 1\n{PUBLISH}"),
        (PUBLISH, f'        if self.count <= 5:\n    {PUBLISH}'),
    ),
    wrong('publishes twice', 'A scan leads to one point.'),
    wrong(
        'reliable',
        'uses reliability reliable',
        ('self.on_scan, qos_profile_sensor_data', 'self.on_scan, 10'),
        ('from rclpy.qos import qos_profile_sensor_data\n', ''),
    ),
    wrong(
        'the height is forgotten',
        'It is another point, or another frame.',
        (PUBLISH, f'        found.point.z = 0.0\n{PUBLISH}'),
    ),
    wrong(
        'the first one again and again',
        'It is another point, or another frame.',
        (
            PUBLISH,
            "        self.first = getattr(self, 'first', found.point)\n"
            f'        found.point = self.first\n{PUBLISH}',
        ),
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    right(
        'by the transform of the buffer',
        (
            LOOKUP,
            "            found = self.buffer.transform(point, 'odom')\n",
        ),
        ('        frame, stamp = scan.header.frame_id, Time.from_msg(scan.header.stamp)\n', ''),
        ('        found = do_transform_point(point, transform)\n', ''),
        ('from rclpy.time import Time\n', ''),
        ('from tf2_geometry_msgs import do_transform_point\n', ''),
        ('import math\n\n', 'import math\n\nimport tf2_geometry_msgs\n'),
    ),
    right(
        'asks first',
        (
            '        try:\n' + LOOKUP,
            "        if not self.buffer.can_transform('odom', frame, stamp):\n"
            '            return\n' + LOOKUP.replace('            ', '        ', 1),
        ),
        (
            '        except TransformException as error:\n'
            '            self.get_logger().info(str(error), throttle_duration_sec=5.0)\n'
            '            return\n',
            '',
        ),
        ('Buffer, TransformException, TransformListener', 'Buffer, TransformListener'),
    ),
    right(
        'the stamp as it is',
        ('Time.from_msg(scan.header.stamp)', 'scan.header.stamp'),
        ('from rclpy.time import Time\n', ''),
    ),
    right(
        'with numpy',
        ('import math\n\n', 'import numpy as np\n'),
        (
            '        beams = enumerate(scan.ranges)\n'
            '        valid = [(d, i) for i, d in beams if scan.range_min <= d <= scan.range_max]\n'
            '        if not valid:\n            return\n'
            '        distance, i = min(valid)\n',
            '        ranges = np.array(scan.ranges, float)\n'
            '        valid = (ranges >= scan.range_min) & (ranges <= scan.range_max)\n'
            '        if not valid.any():\n            return\n'
            '        i = int(np.argmin(np.where(valid, ranges, np.inf)))\n'
            '        distance = float(ranges[i])\n',
        ),
        ('distance * math.cos(angle)', 'float(distance * np.cos(angle))'),
        ('distance * math.sin(angle)', 'float(distance * np.sin(angle))'),
    ),
]
