import threading

import rclpy
from geometry_msgs.msg import Twist
from std_msgs.msg import Empty

import labkit as lab

node = lab.spin(rclpy.create_node('surveyor'))
publisher = node.create_publisher(Twist, '/cmd_vel', 10)
started = threading.Event()


def send(v, w, steps):
    msg = Twist()
    msg.linear.x, msg.angular.z = v, w
    for _ in range(steps):
        publisher.publish(msg)
        rate.sleep()


def work():
    while started.wait():
        started.clear()
        for _ in range(4):
            send(0.2, 0.0, 20)
            send(0.0, 1.5708, 10)
            send(0.0, 0.0, 6)


rate = node.create_rate(10)
node.create_subscription(Empty, '/go_square', lambda msg: started.set(), 10)
threading.Thread(target=work, daemon=True).start()
