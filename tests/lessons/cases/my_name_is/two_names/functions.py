import rclpy
from std_msgs.msg import String

import labkit as lab


def introduce(name):
    node = rclpy.create_node('stage_' + name.lower())
    publisher = node.create_publisher(String, '/names', 10)

    def answer(text):
        publisher.publish(String(data=text.data + name))

    node.create_subscription(String, '/incomplete', answer, 10)
    lab.spin(node)


for name in ('Eve', 'Finn', 'Gus'):
    introduce(name)
