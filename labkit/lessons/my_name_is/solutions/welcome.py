from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Host(Node):
    def __init__(self):
        super().__init__('host')
        self.publisher = self.create_publisher(String, 'welcome', 10)
        self.subscription = self.create_subscription(String, 'names', self.on_text, 10)

    def on_text(self, msg):
        self.publisher.publish(String(data=msg.data + '. Welcome!'))


class Guest(Node):
    def __init__(self, node_name, first_name):
        super().__init__(node_name)
        self.first_name = first_name
        self.publisher = self.create_publisher(String, 'names', 10)
        self.subscription = self.create_subscription(String, 'incomplete', self.on_text, 10)

    def on_text(self, msg):
        self.publisher.publish(String(data=msg.data + self.first_name))


host = lab.spin(Host())
ada = lab.spin(Guest('ada', 'Ada'))
bob = lab.spin(Guest('bob', 'Bob'))
