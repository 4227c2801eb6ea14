from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Door(Node):
    def __init__(self):
        super().__init__('door')
        self.publisher = self.create_publisher(String, 'door', 10)
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        if self.publisher.get_subscription_count() > 0:
            self.publisher.publish(String(data='The door is open'))
            self.timer.cancel()


door = lab.spin(Door())
