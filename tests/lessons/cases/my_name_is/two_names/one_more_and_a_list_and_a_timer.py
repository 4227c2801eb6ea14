from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Guest(Node):
    def __init__(self, name):
        super().__init__(f'{name.lower()}_node', namespace='party')
        self.name = name
        self.waiting = []
        self.publisher = self.create_publisher(String, '/names', 10)
        self.create_subscription(String, '/incomplete', self.waiting.append, 10)
        self.create_timer(0.3, self.speak)

    def speak(self):
        while self.waiting:
            self.publisher.publish(String(data=self.waiting.pop(0).data + self.name))


guests = [lab.spin(Guest(name)) for name in ('Ada', 'Bob', 'Zoe')]
