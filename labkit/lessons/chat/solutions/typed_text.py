from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Teller(Node):
    def __init__(self):
        super().__init__('teller')
        self.publisher = self.create_publisher(String, 'hall', 10)

    def say(self, text):
        self.publisher.publish(String(data=f'Ada: {text}'))


def ask():
    text = input('Your message: ').strip()
    if text:
        teller.say(text)


teller = lab.spin(Teller())
