mkdir -p nodes
cat > nodes/cruiser.py << END
import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.signals import SignalHandlerOptions

rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
node = rclpy.create_node('cruiser')
publisher = node.create_publisher(Twist, '/cmd_vel', 10)
node.create_timer(0.1, lambda: publisher.publish(Twist(linear=Vector3(x=0.1))))
try:
    rclpy.spin(node)
finally:
    publisher.publish(Twist())
    publisher.wait_for_all_acked()
END
env --default-signal=INT python3 nodes/cruiser.py > cruiser.log 2>&1 &
