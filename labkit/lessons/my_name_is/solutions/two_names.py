from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Introducer(Node):
    def __init__(self, node_name, first_name):
        super().__init__(node_name)
        self.first_name = first_name
        self.publisher = self.create_publisher(String, 'names', 10)
        self.subscription = self.create_subscription(String, 'incomplete', self.on_text, 10)

    def on_text(self, msg):
        self.publisher.publish(String(data=msg.data + self.first_name))


ada = lab.spin(Introducer('ada', 'Ada'))
bob = lab.spin(Introducer('bob', 'Bob'))
