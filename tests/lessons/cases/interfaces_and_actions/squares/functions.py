from rclpy.action import ActionServer
from rclpy.node import Node
from test_msgs.action import Fibonacci

import labkit as lab

node = Node('calculator_of_squares')


def square_numbers(handle):
    result, feedback = Fibonacci.Result(), Fibonacci.Feedback()
    while len(result.sequence) < handle.request.order:
        result.sequence.append(len(result.sequence) ** 2)
        feedback.sequence = result.sequence
        handle.publish_feedback(feedback)
    handle.succeed()
    return result


ActionServer(node, Fibonacci, '/squares', square_numbers)
lab.spin(node)
