from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class SlowTalker(Node):
    def __init__(self):
        super().__init__('slow_talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(2.0, self.on_timer)

    def on_timer(self):
        msg = String()
        msg.data = 'Hello from the slow talker'
        self.publisher.publish(msg)


slow_talker = lab.spin(SlowTalker())
