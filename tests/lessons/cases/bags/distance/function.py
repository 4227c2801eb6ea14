import math

from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float64

import labkit as lab

node = lab.spin(Node('distance'))
publisher = node.create_publisher(Float64, '/distance', 10)
state = {'last': None, 'total': 0.0}


def on_odometry(msg):
    place = (msg.pose.pose.position.x, msg.pose.pose.position.y)
    step = math.dist(state['last'] or place, place)
    state['last'] = place
    state['total'] += step if step < 0.5 else 0.0
    publisher.publish(Float64(data=state['total']))


node.create_subscription(Odometry, '/odom', on_odometry, 10)
