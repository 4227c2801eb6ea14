from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Polite(Node):
    def __init__(self):
        super().__init__('polite')
        self.greeted = {'Ada'}
        self.publisher = self.create_publisher(String, 'lounge', 10)
        self.subscription = self.create_subscription(String, 'lounge', self.on_message, 10)

    def on_message(self, msg):
        who, _, text = msg.data.partition(': ')
        if 'Hello' in text and who not in self.greeted:
            self.greeted.add(who)
            self.publisher.publish(String(data=f'Ada: Hello, {who}'))


polite = lab.spin(Polite())
