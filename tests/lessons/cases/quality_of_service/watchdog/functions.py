import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile
from std_msgs.msg import Empty, String

import labkit as lab

node = rclpy.create_node('doctor')
publisher = node.create_publisher(String, '/alarm', 1)
node.create_subscription(
    Empty,
    '/heartbeat',
    lambda msg: None,
    QoSProfile(depth=1, deadline=Duration(seconds=0.5)),
    event_callbacks=SubscriptionEventCallbacks(
        deadline=lambda event: publisher.publish(String(data=f'missed {event.total_count}'))
    ),
)
lab.spin(node)
