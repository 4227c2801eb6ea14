import rclpy
from std_msgs.msg import String

import labkit as lab

node = rclpy.create_node('butler')
publisher = node.create_publisher(String, '/greeting', 5)


def bow(text):
    publisher.publish(String(data=f'{text.data}. Nice to meet you.'))


node.create_subscription(String, '/complete', bow, 5)
lab.spin(node)
