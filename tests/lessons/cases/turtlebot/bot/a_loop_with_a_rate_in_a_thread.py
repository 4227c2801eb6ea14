import threading

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Empty

import labkit as lab

node = rclpy.create_node('loop_bot')
pub = node.create_publisher(Twist, '/cmd_vel', 1)
state = {'x': 0.0}
started = threading.Event()


def keep(msg):
    state['x'] = msg.pose.pose.position.x


def run():
    while True:
        started.wait()
        started.clear()
        rate = node.create_rate(10)
        for _ in range(20):
            msg = Twist()
            msg.linear.x = -state['x']
            pub.publish(msg)
            rate.sleep()
        pub.publish(Twist())


node.create_subscription(Odometry, '/odom', keep, 1)
node.create_subscription(Empty, '/go_home', lambda msg: started.set(), 1)
lab.spin(node)
threading.Thread(target=run, daemon=True).start()
