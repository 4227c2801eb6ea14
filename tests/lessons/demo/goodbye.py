"""Say something as the node ends: a check that uses up what it checks."""

from __future__ import annotations

from labkit.exercises import Exercise, Probe, Solution, Style, Wrong, changed, expect


def judge_goodbye(probe: Probe) -> str:
    source = expect.publisher(probe, '/demo_speed')
    speeds = expect.messages(probe, source, count=2)
    expect.each(speeds, 'data', lambda v: v == 1.0, expected='1.0 while it runs')
    last = expect.ends_with_node(probe, source)
    expect.that(
        last.values('data')[-1] == 0.0,
        expected='0.0 as the last message',
        seen=f'{last.values("data")[-1]!r}',
        why='The node ends without a word, and whoever listens goes on with the last speed.',
    )
    return 'Its last word was 0.0.'


SPEED = """
from rclpy.node import Node
from std_msgs.msg import Float64


class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.publisher = self.create_publisher(Float64, 'demo_speed', 10)
        self.create_timer(0.05, lambda: self.publisher.publish(Float64(data=1.0)))

    def destroy_node(self):
        self.publisher.publish(Float64(data=0.0))
        super().destroy_node()


lab.spin(Driver())
"""

goodbye = Exercise(
    name='goodbye',
    task='A node that publishes 1.0 on /demo_speed, and 0.0 as its last word.',
    publishes={'/demo_speed': 'std_msgs/msg/Float64'},
    judge=judge_goodbye,
    hints=['What is called when a node ends?', 'destroy_node()'],
    answer=Solution(SPEED, 'destroy_node() is called whatever ends the node.'),
    styles=[
        Style(
            'main() in a process of its own',
            changed(
                SPEED,
                ('from rclpy.node', 'import time\n\nimport rclpy\nfrom rclpy.node'),
                # What is said last takes a moment to be heard in another process.
                ('        super().destroy', '        time.sleep(0.3)\n        super().destroy'),
                (
                    'lab.spin(Driver())',
                    """rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
node = Driver()
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
finally:
    node.destroy_node()""",
                ),
            ),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'ends silently',
            changed(SPEED, ('self.publisher.publish(Float64(data=0.0))', 'pass')),
            'The node ends without a word',
        ),
    ],
    once=True,
)
