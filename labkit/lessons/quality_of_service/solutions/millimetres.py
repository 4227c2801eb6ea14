from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Int16

import labkit as lab


class Millimetres(Node):
    def __init__(self):
        super().__init__('millimetres')
        self.publisher = self.create_publisher(Int16, 'range_mm', 10)
        self.subscription = self.create_subscription(
            Int16, 'range', self.on_range, qos_profile_sensor_data
        )

    def on_range(self, msg):
        self.publisher.publish(Int16(data=10 * msg.data))


millimetres = lab.spin(Millimetres())
