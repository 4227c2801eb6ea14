mkdir -p nodes
cat > nodes/evens.py << END
import rclpy
from std_msgs.msg import Int16

rclpy.init()
node = rclpy.create_node('evens')
publisher = node.create_publisher(Int16, '/evens', 10)
node.create_subscription(
    Int16, '/odds', lambda odd: publisher.publish(Int16(data=odd.data + 1)), 10
)
rclpy.spin(node)
END
python3 nodes/evens.py > evens.log 2>&1 &
