import rclpy
from rclpy.duration import Duration
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('clock_watcher')
publisher = node.create_publisher(String, '/incomplete', 1)
due = node.get_clock().now()


def look():
    global due
    if node.get_clock().now() >= due:
        due = node.get_clock().now() + Duration(seconds=0.5)
        publisher.publish(String(data='My name is '))


node.create_timer(0.1, look)
rclpy.spin(node)
