import rclpy
from rclpy.node import Node
from std_msgs.msg import Int16


class Millimetres(Node):
    def __init__(self):
        super().__init__('millimetres')
        self.publisher = self.create_publisher(Int16, 'range_mm', 10)
        self.subscription = self.create_subscription(Int16, 'range', self.on_range, 10)

    def on_range(self, msg):
        self.publisher.publish(Int16(data=10 * msg.data))


def main():
    rclpy.init()
    sonar = Node('sonar')
    sonar.create_publisher(Int16, 'range', 10)
    rclpy.spin(Millimetres())


main()
