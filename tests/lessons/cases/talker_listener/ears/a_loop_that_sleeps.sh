cat > nodes/ear.py << END
import time

import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('ear')
publisher = node.create_publisher(String, 'sound', 10)
while rclpy.ok():
    publisher.publish(String(data='wind'))
    time.sleep(0.2)
END
python3 nodes/ear.py --ros-args -r __node:=left_ear > left_ear.log 2>&1 &
python3 nodes/ear.py --ros-args -r __node:=right_ear > right_ear.log 2>&1 &
