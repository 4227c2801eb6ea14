mkdir -p nodes
cat > nodes/stage_one.py << END
import rclpy
from rclpy.duration import Duration
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('stage_one')
publisher = node.create_publisher(String, '/incomplete', 1)
due = node.get_clock().now()


def look():
    global due
    if node.get_clock().now() >= due:
        due = node.get_clock().now() + Duration(seconds=0.5)
        publisher.publish(String(data='My name is '))


node.create_timer(0.1, look)
rclpy.spin(node)
END
python3 nodes/stage_one.py > stage_one.log 2>&1 &
