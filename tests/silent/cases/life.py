"""Life of nodes and calls, see `labkit.silent.spinning_faults`."""

_SERVER = "node('server').create_service(Trigger, 'work', lambda request, response: response)\n"
_UNSPUN = (
    f"{_SERVER}n = Node('caller'); c = n.create_client(Trigger, 'work'); c.wait_for_service()\n"
)

# A subscription, and a timer whose callback does not return.
_HELD = (
    'from rclpy.callback_groups import MutuallyExclusiveCallbackGroup\n'
    'from rclpy.executors import MultiThreadedExecutor\n'
    'free, begun = threading.Event(), threading.Event()\n'
    'def tick(): begun.set(); free.wait()\n'
    "n = Node('own'); n.create_subscription(String, 'chatter', heard, 10)\n"
    'n.create_timer(0.01, tick{group}); e = MultiThreadedExecutor(2); e.add_node(n)\n'
    'threading.Thread(target=e.spin, daemon=True).start(); begun.wait(); time.sleep(2.1)'
)

CASES = {
    'life.held-executor': (
        _HELD.format(group=''),
        f'free.set()\n{_HELD}'.format(group=', MutuallyExclusiveCallbackGroup()'),
    ),
    'life.rate-unspun': (
        "n = Node('sleepy'); r = n.create_rate(10)\n"
        'threading.Thread(target=r.sleep, daemon=True).start()\n'
        'lab.wait_until(lambda: runtime.waits)',
        "n = node('sleepy'); r = n.create_rate(10)\n"
        'threading.Thread(target=r.sleep, daemon=True).start()',
    ),
    'life.client-unspun': (
        f'{_UNSPUN}c.call_async(Trigger.Request())',
        _UNSPUN,
    ),
    'life.no-server': (
        "node('caller').create_client(Trigger, 'work').call_async(Trigger.Request())",
        f"{_SERVER}c = node('caller').create_client(Trigger, 'work'); c.wait_for_service()\n"
        'f = c.call_async(Trigger.Request()); lab.wait_until(f.done)',
    ),
    'life.subscribed-twice': (
        "n = deaf('listener', 'chatter'); n.create_subscription(String, 'chatter', heard, 10)",
        "n = deaf('listener', 'chatter'); n.create_subscription(String, 'chatter', print, 10)",
    ),
    'life.publisher-again': (
        "n = node('talker'); [n.create_publisher(String, 'chatter', 10) for _ in range(5)]",
        "n = node('talker'); [n.create_publisher(String, f'chatter{i}', 10) for i in range(5)]",
    ),
    'life.timer-again': (
        "n = node('talker'); [n.create_timer(1.0, heard) for _ in range(5)]",
        "n = node('talker'); [n.create_timer(1.0, heard).cancel() for _ in range(5)]",
    ),
}
