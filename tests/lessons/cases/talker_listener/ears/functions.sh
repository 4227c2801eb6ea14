cat > nodes/ear.py << END
import rclpy
from std_msgs.msg import String

if __name__ == '__main__':
    rclpy.init()
    node = rclpy.create_node('ear')
    publisher = node.create_publisher(String, '/sound', 1)
    node.create_timer(1 / 5, lambda: publisher.publish(String(data='rain')))
    rclpy.spin(node)
END
python3 nodes/ear.py --ros-args -r __node:=left_ear > left_ear.log 2>&1 &
python3 nodes/ear.py --ros-args -r __node:=right_ear > right_ear.log 2>&1 &
