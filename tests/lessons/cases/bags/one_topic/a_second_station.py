from rclpy.node import Node
from std_msgs.msg import Float64

import labkit as lab

node = lab.spin(Node('second_station'))
publisher = node.create_publisher(Float64, 'temperature', 10)
with lab.record(
    'bags/temperature', '/temperature', storage='sqlite3', overwrite=True
) as recording:
    recording.wait_for(5)
    publisher.publish(Float64(data=-40.0))
    recording.wait_for(25)
