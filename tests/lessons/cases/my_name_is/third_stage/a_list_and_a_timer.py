from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Patient(Node):
    def __init__(self):
        super().__init__('converter')
        self.waiting = []
        self.create_subscription(String, 'complete', self.waiting.append, 10)
        self.publisher = self.create_publisher(String, 'greeting', 10)
        self.create_timer(0.2, self.greet)

    def greet(self):
        while self.waiting:
            text = self.waiting.pop(0).data
            self.publisher.publish(String(data=text + '. Nice to meet you.'))


patient = lab.spin(Patient())
