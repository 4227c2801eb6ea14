from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Opener(Node):
    def __init__(self):
        super().__init__('opener')
        self.publisher = self.create_publisher(String, 'incomplete', 10)
        self.timer = self.create_timer(0.5, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='My name is '))


class Completer(Node):
    def __init__(self):
        super().__init__('completer')
        self.publisher = self.create_publisher(String, 'complete', 10)
        self.subscription = self.create_subscription(String, 'incomplete', self.on_text, 10)

    def on_text(self, msg):
        self.publisher.publish(String(data=msg.data + 'Ada'))


completer = lab.spin(Completer())
opener = lab.spin(Opener())
