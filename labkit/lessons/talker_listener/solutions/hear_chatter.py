from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Diary(Node):
    def __init__(self):
        super().__init__('diary')
        self.subscription = self.create_subscription(String, 'chatter', self.on_message, 10)

    def on_message(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')


diary = lab.spin(Diary())
