import rclpy
from std_msgs.msg import String

import labkit as lab

node = rclpy.create_node('host')
publisher = node.create_publisher(String, '/lounge', 10)
known = []


def greet(msg):
    who = msg.data.split(': ')[0]
    said = msg.data[len(who) + 2 :]
    if who == 'Ada' or 'Hello' not in said or who in known:
        return
    known.append(who)
    publisher.publish(String(data='Ada: Hello, ' + who))


node.create_subscription(String, '/lounge', greet, 10)
lab.spin(node)
