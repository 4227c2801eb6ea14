from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Door(Node):
    def __init__(self):
        super().__init__('front_door')
        self.said = False
        self.publisher = self.create_publisher(
            String,
            '/door',
            1,
            event_callbacks=PublisherEventCallbacks(matched=self.on_matched),
        )

    def on_matched(self, info):
        if info.current_count > 0 and not self.said:
            self.publisher.publish(String(data='The door is open'))
            self.said = True


lab.spin(Door())
