# In the editor, a new file nodes/evens.py:
mkdir -p nodes
cat > nodes/evens.py << END
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Int16


class Evens(Node):
    def __init__(self):
        super().__init__('evens')
        self.publisher = self.create_publisher(Int16, 'evens', 10)
        self.subscription = self.create_subscription(Int16, 'odds', self.on_odd, 10)

    def on_odd(self, msg):
        even = Int16()
        even.data = msg.data + 1
        self.publisher.publish(even)


def main():
    rclpy.init()
    try:
        rclpy.spin(Evens())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
END
# In a terminal, after the line with export:
python3 nodes/evens.py > evens.log 2>&1 &
