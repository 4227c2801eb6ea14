"""Answers to `stop`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'stops too late',
        'destroy_node of /cruiser raised InvalidHandle',
        (
            '\n    def destroy_node(self):\n        self.publisher.publish(Twist())\n'
            '        super().destroy_node()\n',
            '\n    def destroy_node(self):\n        super().destroy_node()\n'
            '        self.publisher.publish(Twist())\n',
        ),
        outcome=ERROR,
    ),
    wrong(
        'an int in a float field', 'takes values of type float', ('= 0.1', '= 1'), outcome=ERROR
    ),
    wrong(
        'another name',
        'Capital and small letters differ in names',
        ("__init__('cruiser')", "__init__('Cruiser')"),
    ),
    wrong(
        'eight commands a second',
        'a message every 0.125 s (8 Hz)',
        ('create_timer(0.1,', 'create_timer(0.125,'),
    ),
    wrong(
        'a script with the signal handlers of rclpy',
        'With Ctrl-C this handler shuts ROS down',
        ('rclpy.init(signal_handler_options=SignalHandlerOptions.NO)', 'rclpy.init()'),
        ('from rclpy.signals import SignalHandlerOptions\n', ''),
        ('    rclpy.shutdown()\n', '    rclpy.try_shutdown()\n'),
        of='a script with finally',
        run='process',
    ),
    wrong(
        'publishes before the robot listens',
        'nobody was there to hear it',
        (
            '        self.timer = self.create_timer(0.1, self.on_timer)\n',
            '        self.on_timer()\n',
        ),
    ),
    wrong(
        'a script that publishes before the robot listens',
        'publish() was called too early',
        ('node.create_timer(0.1, drive)', 'drive()'),
        of='a script with finally',
        run='process',
    ),
    wrong(
        'the speed ramps up',
        'each command says',
        ('        self.publisher =', '        self.speed = 0.0\n        self.publisher ='),
        (
            '        msg.linear.x = 0.1\n',
            '        self.speed = min(0.1, self.speed + 0.02)\n'
            '        msg.linear.x = self.speed\n',
        ),
        ('Cruiser())\n', 'Cruiser())\nlab.wait_until(lambda: cruiser.speed >= 0.1)\n'),
    ),
    wrong(
        'best effort',
        '/cruiser offers best effort',
        ('import Node\n', 'import Node\nfrom rclpy.qos import qos_profile_sensor_data\n'),
        ("'cmd_vel', 10", "'cmd_vel', qos_profile_sensor_data"),
    ),
    wrong(
        'a second one drives on',
        'The robot does what the newest command says',
        ('(self):\n        super', "(self, name='cruiser'):\n        super"),
        ("__init__('cruiser')", '__init__(name)'),
        ('Cruiser())\n', "Cruiser())\nhelper = lab.spin(Cruiser('helper'))\n"),
    ),
    wrong(
        'a script without finally',
        'The node ends without a word.',
        ('    publisher.publish(Twist())\n', ''),
        of='a script with finally',
        run='process',
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    right(
        'says stop twice',
        (
            '        super().destroy_node()',
            '        self.timer.cancel()\n        self.publisher.publish(Twist())\n'
            '        super().destroy_node()',
        ),
    ),
    right(
        'each fifth call of a fast timer',
        ('create_timer(0.1,', 'create_timer(0.02,'),
        ('        self.publisher =', '        self.calls = 0\n        self.publisher ='),
        (
            '    def on_timer(self):\n',
            '    def on_timer(self):\n        self.calls += 1\n'
            '        if self.calls % 5:\n            return\n',
        ),
    ),
    right(
        'a thread with a rate',
        ('from geometry', '\nimport threading\n\nimport rclpy\nfrom geometry'),
        (
            '        self.timer = self.create_timer(0.1, self.on_timer)\n',
            '        self.rate = self.create_rate(10)\n        self.driving = True\n'
            '        self.thread = threading.Thread(target=self.drive, daemon=True)\n'
            '        self.thread.start()\n\n    def drive(self):\n'
            '        while self.driving and rclpy.ok():\n            self.on_timer()\n'
            '            self.rate.sleep()\n',
        ),
        (
            '    def destroy_node(self):\n',
            '    def destroy_node(self):\n        self.driving = False\n'
            '        self.rate.destroy()\n        self.thread.join(1.0)\n',
        ),
    ),
    right('a script with finally', run='process'),
    right(
        'a script with a loop',
        ('    rclpy.spin(node)\n', '    while True:\n        rclpy.spin_once(node)\n'),
        of='a script with finally',
        run='process',
    ),
]
