from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Polite(Node):
    def __init__(self):
        super().__init__('polite')
        self.publisher = self.create_publisher(String, 'greeting', 10)
        self.subscription = self.create_subscription(String, 'complete', self.on_text, 10)

    def on_text(self, msg):
        self.publisher.publish(String(data=msg.data + '. Nice to meet you.'))


polite = lab.spin(Polite())
