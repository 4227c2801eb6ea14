"""Nodes that labkit knows nothing of, for the tests: a robot, a lamp, a hidden one.

Prints `ready` when all of them are there; ends when its standard input is closed.
"""

import sys
import threading

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Int16, String
from std_srvs.srv import SetBool


class Robot(Node):
    def __init__(self):
        super().__init__('robot', namespace='fleet')
        self.chatter = self.create_publisher(String, '/chatter', 10)
        self.odom = self.create_publisher(Odometry, '/odom', 10)
        self.scan = self.create_publisher(LaserScan, '/scan', qos_profile_sensor_data)
        self.create_subscription(Twist, '/cmd_vel', lambda message: None, 10)
        self.heard = []
        self.create_subscription(Int16, '/odds', self.on_odds, 10)
        self.echo = self.create_publisher(String, '/heard', QoSProfile(depth=1, durability=1))
        self.count = 0
        self.create_timer(0.05, self.on_timer)

    def on_timer(self):
        self.chatter.publish(String(data=f'Hello {self.count}'))
        odom = Odometry()
        odom.header.stamp = self.get_clock().now().to_msg()
        odom.pose.pose.position.x = 1.5
        self.odom.publish(odom)
        self.scan.publish(LaserScan(ranges=[1.0] * 200))
        self.count += 1

    def on_odds(self, message):
        self.heard.append(str(message.data))
        self.echo.publish(String(data=','.join(self.heard)))


class Lamp(Node):
    def __init__(self):
        super().__init__('lamp')
        self.create_service(SetBool, 'switch', self.on_switch)
        limits = IntegerRange(from_value=0, to_value=10, step=1)
        self.declare_parameter(
            'speed', 5, ParameterDescriptor(description='how fast', integer_range=[limits])
        )
        self.declare_parameter('pid.p', 1.5)
        self.declare_parameter('names', ['a', 'b'])

    def on_switch(self, request, response):
        response.success = request.data
        response.message = 'on' if request.data else 'off'
        return response


rclpy.init()
executor = SingleThreadedExecutor()
hidden = Node('_hidden')
hidden.create_publisher(String, '/_secret', 10)
for node in (Robot(), Lamp(), hidden):
    executor.add_node(node)
threading.Thread(target=lambda: (sys.stdin.read(), rclpy.try_shutdown()), daemon=True).start()
print('ready', flush=True)
try:
    executor.spin()
except rclpy.executors.ExternalShutdownException:
    pass
