mkdir -p nodes
cat > nodes/stage_one.py << END
import time

import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('stage_one')
publisher = node.create_publisher(String, '/incomplete', 1)
for _ in range(30):
    publisher.publish(String(data='My name is '))
    time.sleep(0.5)
END
python3 nodes/stage_one.py > stage_one.log 2>&1 &
