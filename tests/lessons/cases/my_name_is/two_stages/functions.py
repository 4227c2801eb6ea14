import rclpy
from std_msgs.msg import String

import labkit as lab

one, two = rclpy.create_node('first'), rclpy.create_node('second')
begin = one.create_publisher(String, '/incomplete', 1)
end = two.create_publisher(String, '/complete', 1)
one.create_timer(1 / 2, lambda: begin.publish(String(data='My name is ')))
two.create_subscription(
    String, '/incomplete', lambda text: end.publish(String(data=f'{text.data}Jean-Luc')), 1
)
lab.spin(one)
lab.spin(two)
