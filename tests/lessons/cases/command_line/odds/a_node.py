import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('odd_node')
publisher = node.create_publisher(Int16, 'odds', 10)
for number in (1, 3, 5):
    publisher.publish(Int16(data=number))
