# In the editor, a new file nodes/cruiser.py:
mkdir -p nodes
cat > nodes/cruiser.py << END
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions


class Cruiser(Node):
    def __init__(self):
        super().__init__('cruiser')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        msg = Twist()
        msg.linear.x = 0.1
        self.publisher.publish(msg)


def main():
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = Cruiser()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.publisher.publish(Twist())
        node.publisher.wait_for_all_acked()


if __name__ == '__main__':
    main()
END
# In a terminal, after the line with export:
env --default-signal=INT python3 nodes/cruiser.py > cruiser.log 2>&1 &
