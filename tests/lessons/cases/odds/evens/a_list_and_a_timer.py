from rclpy.node import Node
from std_msgs.msg import Int16

import labkit as lab


class Postman(Node):
    def __init__(self):
        super().__init__('postman')
        self.waiting = []
        self.create_subscription(Int16, 'odds', self.waiting.append, 10)
        self.publisher = self.create_publisher(Int16, 'evens', 10)
        self.create_timer(0.05, self.deliver)

    def deliver(self):
        while self.waiting:
            self.publisher.publish(Int16(data=self.waiting.pop(0).data + 1))


postman = lab.spin(Postman())
