import math
import threading

import rclpy
from geometry_msgs.msg import Twist
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Empty

import labkit as lab

node = lab.spin(rclpy.create_node('look_out'))
pub = node.create_publisher(Twist, '/cmd_vel', 10)
state = {'ahead': math.inf}
started = threading.Event()


def on_scan(msg):
    ahead = [*msg.ranges[:10], *msg.ranges[-10:]]
    state['ahead'] = min((way for way in ahead if way > 0), default=math.inf)


def run():
    rate = node.create_rate(10)
    while True:
        started.wait()
        started.clear()
        while state['ahead'] >= 0.5:
            msg = Twist()
            msg.linear.x = 0.2
            pub.publish(msg)
            rate.sleep()
        pub.publish(Twist())


node.create_subscription(LaserScan, '/scan', on_scan, qos_profile_sensor_data)
node.create_subscription(Empty, '/go_wall', lambda msg: started.set(), 1)
threading.Thread(target=run, daemon=True).start()
