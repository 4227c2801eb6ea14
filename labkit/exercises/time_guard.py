"""Give nodes their own time back when the process that has taken it is killed.

Started with a Python and the names of the nodes. It waits at its standard input: `done` says that
all is well, an end without a word that the other process is no more.
"""

import os
import sys
from typing import Any

if __name__ == '__main__':
    if sys.stdin.buffer.read() != b'done':
        python, *names = sys.argv[1:]
        code = (
            'import sys; from labkit.exercises.time_guard import give_back; '
            'give_back(sys.argv[1:])'
        )
        folder = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
        os.environ['PYTHONPATH'] = folder
        os.execv(python, [python, '-c', code, *names])


def give_back(names: 'list[str]') -> None:
    """Set `use_sim_time` of these nodes to false."""
    import rclpy
    from rcl_interfaces.srv import SetParameters
    from rclpy.parameter import Parameter

    rclpy.init()
    node = rclpy.create_node('_time_guard')
    parameter: Any = Parameter('use_sim_time', value=False)  # type: ignore[no-untyped-call]
    request = SetParameters.Request(parameters=[parameter.to_parameter_msg()])
    for name in names:
        client = node.create_client(SetParameters, f'{name}/set_parameters')
        if client.wait_for_service(5.0):
            future = client.call_async(request)
            rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
    rclpy.shutdown()
