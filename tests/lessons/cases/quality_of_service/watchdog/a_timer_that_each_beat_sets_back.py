from rclpy.node import Node
from std_msgs.msg import Empty, String

import labkit as lab


class Watchdog(Node):
    def __init__(self):
        super().__init__('watchdog')
        self.publisher = self.create_publisher(String, 'alarm', 10)
        self.subscription = self.create_subscription(Empty, 'heartbeat', self.on_beat, 10)
        self.timer = self.create_timer(0.5, self.on_timer)

    def on_beat(self, msg):
        self.timer.reset()

    def on_timer(self):
        self.publisher.publish(String(data='no heartbeat'))


watchdog = lab.spin(Watchdog())
