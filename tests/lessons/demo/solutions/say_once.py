import rclpy
from std_msgs.msg import String

node = rclpy.create_node('once')
pub = node.create_publisher(String, 'demo_news', 10)
pub.publish(String(data='late'))
