from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Mouth(Node):
    def __init__(self):
        super().__init__('mouth')
        self.publisher = self.create_publisher(String, 'speech', 10)
        self.create_subscription(String, 'thought', self.on_thought, 10)

    def on_thought(self, msg):
        self.publisher.publish(String(data=msg.data.upper()))


mouth = lab.spin(Mouth())
