"""Types and QoS, see `labkit.silent.matching_faults`."""


def _types(mine: str, theirs: str) -> str:
    topic = f'{mine}_of_{theirs}'.lower()  # the graph may still know the last case's
    return (
        f"deaf('robot', '{topic}', {mine})\nother = other_process('driver')\n"
        f"ORIGINALS['create_publisher'](other, {theirs}, '{topic}', 10)\n"
        f"lab.wait_until(lambda: runtime.helper.count_publishers('/{topic}'), timeout_sec=20)\n"
        'all_named(3)'
    )


def _profiles(asked: str, offered: str) -> str:
    return (
        f"deaf('listener', 'topic', qos=QoSProfile(depth=5, {asked}))\n"
        f"loud('talker', 'topic', qos=QoSProfile(depth=5, {offered}))"
    )


_KEEP = 'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)'
_KEEP_ALL = 'QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)'
_BURST = (
    "n = deaf('listener', 'topic', qos={depth}); p = loud('talker', 'topic', qos=100)\n"
    'look()\n'
    "n.create_timer(0.01, lambda: [p.publish(String(data='x')) for _ in range(20)])\n"
    'lab.wait_until(lambda: runtime.entry_of(n).callbacks > 15, timeout_sec=20)'
)
_FOUR_TIMES = (
    "p = loud('talker', 'topic', qos=QoSProfile(depth=1, {policies}))\n"
    'for _ in range(4):\n    p.publish(String()); time.sleep(0.02)'
)

CASES = {
    'types.stamped': (_types('TwistStamped', 'Twist'), _types('Twist', 'Twist')),
    'types.size': (_types('Int32', 'Int16'), _types('Int16', 'Int16')),
    'types.other': (_types('String', 'Twist'), _types('Twist', 'Twist')),
    'types.service': (
        "node('server').create_service(SetBool, 'lamp', heard)\n"
        "other_process('client').create_client(Trigger, 'lamp')\n"
        "served('/lamp', 1); all_named(3)",
        # Two servers of two types, and the client finds its own.
        "node('server').create_service(SetBool, 'lamp', heard)\n"
        "other_process('client').create_client(SetBool, 'lamp')\n"
        "other_process('another').create_service(Trigger, 'lamp', heard)\n"
        "served('/lamp', 2); all_named(4)",
    ),
    'qos.reliability': (
        _profiles('', 'reliability=ReliabilityPolicy.BEST_EFFORT'),
        _profiles('reliability=ReliabilityPolicy.BEST_EFFORT', ''),
    ),
    'qos.durability': (
        _profiles('durability=DurabilityPolicy.TRANSIENT_LOCAL', ''),
        _profiles('', 'durability=DurabilityPolicy.TRANSIENT_LOCAL'),
    ),
    'qos.deadline': (
        _profiles('deadline=Duration(seconds=1)', ''),
        _profiles('', 'deadline=Duration(seconds=1)'),
    ),
    'qos.liveliness': (
        _profiles('liveliness=LivelinessPolicy.MANUAL_BY_TOPIC', ''),
        _profiles('', 'liveliness=LivelinessPolicy.MANUAL_BY_TOPIC'),
    ),
    'qos.lease': (
        _profiles('liveliness_lease_duration=Duration(seconds=1)', ''),
        _profiles('', 'liveliness_lease_duration=Duration(seconds=1)'),
    ),
    'qos.depth': (_BURST.format(depth=2), _BURST.format(depth=100)),
    'qos.late': (
        "loud('talker', 'topic').publish(String()); deaf('listener', 'topic')",
        "loud('talker', 'topic'); deaf('listener', 'topic')",
    ),
    'qos.kept': (
        f"p = loud('talker', 'topic', qos={_KEEP})\n"
        f"p.publish(String()); p.publish(String()); deaf('listener', 'topic', qos={_KEEP_ALL})",
        f"p = loud('talker', 'topic', qos={_KEEP_ALL})\n"
        f"p.publish(String()); p.publish(String()); deaf('listener', 'topic', qos={_KEEP_ALL})",
    ),
    'qos.lifespan': (
        _FOUR_TIMES.format(
            policies='durability=DurabilityPolicy.TRANSIENT_LOCAL,'
            'lifespan=Duration(nanoseconds=10**6)'
        ),
        _FOUR_TIMES.format(
            policies='durability=DurabilityPolicy.TRANSIENT_LOCAL,lifespan=Duration(seconds=60)'
        ),
    ),
    'qos.deadline-missed': (
        _FOUR_TIMES.format(policies='deadline=Duration(nanoseconds=10**6)'),
        _FOUR_TIMES.format(policies='deadline=Duration(seconds=60)'),
    ),
}
