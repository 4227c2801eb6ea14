from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Both(Node):
    def __init__(self):
        super().__init__('both')
        self.begin = self.create_publisher(String, 'incomplete', 10)
        self.end = self.create_publisher(String, 'complete', 10)
        self.create_subscription(String, 'incomplete', self.on_text, 10)
        self.create_timer(0.5, lambda: self.begin.publish(String(data='My name is ')))

    def on_text(self, msg):
        self.end.publish(String(data=msg.data + 'Ada'))


lab.spin(Both())
