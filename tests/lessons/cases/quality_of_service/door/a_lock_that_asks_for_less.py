import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Int16


class Door(Node):
    def __init__(self):
        super().__init__('door')
        self.publisher = self.create_publisher(Int16, 'door', qos_profile_sensor_data)
        self.timer = self.create_timer(0.2, self.on_timer)

    def on_timer(self):
        self.publisher.publish(Int16(data=1))


def main():
    rclpy.init()
    lock = Node('lock')
    lock.create_subscription(Int16, 'door', print, 10)
    rclpy.spin(Door())


main()
