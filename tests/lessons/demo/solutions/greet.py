from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Greeter(Node):
    def __init__(self):
        super().__init__('greeter')
        self.publisher = self.create_publisher(String, 'demo_complete', 10)
        self.subscription = self.create_subscription(String, 'demo_incomplete', self.on_text, 10)

    def on_text(self, msg):
        self.get_logger().info(f'I heard: {msg.data}')
        reply = String(data=msg.data + 'Ada')
        self.publisher.publish(reply)


lab.spin(Greeter())
