from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class StageOne(Node):
    def __init__(self):
        super().__init__('stage_one')
        self.publisher = self.create_publisher(String, 'incomplete', 10)
        self.timer = self.create_timer(0.5, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='My name is '))


stage_one = lab.spin(StageOne())
