from rclpy.node import Node
from std_msgs.msg import Float64

import labkit as lab


class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.publisher = self.create_publisher(Float64, 'demo_speed', 10)
        self.create_timer(0.05, lambda: self.publisher.publish(Float64(data=1.0)))

    def destroy_node(self):
        self.publisher.publish(Float64(data=0.0))
        super().destroy_node()


lab.spin(Driver())
