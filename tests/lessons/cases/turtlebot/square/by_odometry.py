import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Empty

import labkit as lab

node = rclpy.create_node('by_odometry')
pub = node.create_publisher(Twist, '/cmd_vel', 10)
state = {'pose': None, 'todo': []}


def on_odometry(msg):
    q, p = msg.pose.pose.orientation, msg.pose.pose.position
    state['pose'] = p.x, p.y, 2 * math.atan2(q.z, q.w)


def on_go(msg):
    x, y, yaw = state['pose']
    corners = [(0.4, 0.0), (0.4, 0.4), (0.0, 0.4), (0.0, 0.0)]
    state['todo'] = [
        (x + a * math.cos(yaw) - b * math.sin(yaw), y + a * math.sin(yaw) + b * math.cos(yaw))
        for a, b in corners
    ]


def on_timer():
    if not state['todo']:
        return
    x, y, yaw = state['pose']
    dx, dy = state['todo'][0][0] - x, state['todo'][0][1] - y
    error = math.remainder(math.atan2(dy, dx) - yaw, math.tau)
    msg = Twist()
    if math.hypot(dx, dy) < 0.03:
        state['todo'].pop(0)
    elif abs(error) > 0.2:
        msg.angular.z = 2.0 * error
    else:
        msg.linear.x, msg.angular.z = 0.2, 2.0 * error
    pub.publish(msg)


node.create_subscription(Odometry, 'odom', on_odometry, 10)
node.create_subscription(Empty, 'go_square', on_go, 10)
node.create_timer(0.1, on_timer)
lab.spin(node)
