"""Answers to `goodbye`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'ends silently',
        'The node ends without a word',
        ('self.publisher.publish(Float64(data=0.0))', 'pass'),
    ),
    right(
        'main() in a process of its own',
        ('from rclpy.node', 'import time\n\nimport rclpy\nfrom rclpy.node'),
        # What is said last takes a moment to be heard in another process.
        ('        super().destroy', '        time.sleep(0.3)\n        super().destroy'),
        (
            'lab.spin(Driver())',
            'rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)\n'
            'node = Driver()\ntry:\n    rclpy.spin(node)\nexcept KeyboardInterrupt:\n'
            '    pass\nfinally:\n    node.destroy_node()',
        ),
        run='process',
    ),
    right('publishes twice'),
]
