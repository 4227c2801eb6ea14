mkdir -p nodes
cat > nodes/evens.py << END
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int16


class Postman(Node):
    def __init__(self):
        super().__init__('evens')
        self.waiting = []
        self.create_subscription(Int16, 'odds', self.waiting.append, 10)
        self.publisher = self.create_publisher(Int16, 'evens', 10)
        self.create_timer(0.05, self.deliver)

    def deliver(self):
        while self.waiting:
            self.publisher.publish(Int16(data=self.waiting.pop(0).data + 1))


rclpy.init()
rclpy.spin(Postman())
END
python3 nodes/evens.py > evens.log 2>&1 &
