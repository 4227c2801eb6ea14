import rclpy
from rclpy.duration import Duration
from std_msgs.msg import String

import labkit as lab

node = rclpy.create_node('polite_one')


def reply(msg):
    if msg.data.find('Hello') < 0:
        return
    mouth = node.create_publisher(String, '/lobby', 1)
    answer = String()
    answer.data = 'Ada: Salut'
    mouth.publish(answer)
    mouth.wait_for_all_acked(Duration(seconds=0.5))
    node.destroy_publisher(mouth)


node.create_subscription(String, '/lobby', reply, 10)
lab.spin(node)
