import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
node = Node('cruiser')
publisher = node.create_publisher(Twist, 'cmd_vel', 10)


def drive():
    msg = Twist()
    msg.linear.x = 0.1
    publisher.publish(msg)


node.create_timer(0.1, drive)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
finally:
    publisher.publish(Twist())
    publisher.wait_for_all_acked()
    rclpy.shutdown()
