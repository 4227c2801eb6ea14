from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Empty, String

import labkit as lab


class Watchdog(Node):
    def __init__(self):
        super().__init__('watchdog')
        self.publisher = self.create_publisher(String, 'alarm', 10)
        self.subscription = self.create_subscription(
            Empty,
            'heartbeat',
            self.on_beat,
            QoSProfile(depth=10, deadline=Duration(seconds=0.5)),
            event_callbacks=SubscriptionEventCallbacks(deadline=self.on_missed),
        )

    def on_beat(self, msg):
        pass

    def on_missed(self, event):
        self.publisher.publish(String(data='no heartbeat'))


watchdog = lab.spin(Watchdog())
