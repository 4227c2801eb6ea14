"""Parameters and remapping, see `labkit.silent.parameters`."""


def _file(text: str, args: str = "cli_args=['--ros-args', '--params-file', 'p.yaml']") -> str:
    return (
        f"open('p.yaml', 'w').write({text!r})\n"
        f"n = Node('cruiser', {args}); n.declare_parameter('speed', 1.0); lab.spin(n)"
    )


def _remap(*rules: str, name: str = 'talker') -> str:
    args = [word for rule in rules for word in ('-r', rule)]
    return f"loud({name!r}, 'chatter', cli_args={['--ros-args', *args]!r})"


_HALF = '{speed: 0.5}'

CASES = {
    'parameters.undeclared': (
        "n = Node('cruiser', parameter_overrides=[Parameter('sped', value=0.5)])\n"
        "n.declare_parameter('speed', 1.0); lab.spin(n)",
        "n = Node('cruiser', parameter_overrides=[Parameter('speed', value=0.5)])\n"
        "n.declare_parameter('speed', 1.0); lab.spin(n)",
    ),
    'parameters.file-node': (
        _file(f'cruizer: {{ros__parameters: {_HALF}}}'),
        _file(f'other: {{ros__parameters: {_HALF}}}\ncruiser: {{ros__parameters: {_HALF}}}'),
    ),
    'parameters.file-namespace': (
        _file(f'robot1: {{cruiser: {{ros__parameters: {_HALF}}}}}'),
        _file(f'/**/cruiser: {{ros__parameters: {_HALF}}}'),
    ),
    'parameters.wildcard': (
        _file(f'cruiser: {{ros__parameters: {_HALF}}}\n/**: {{ros__parameters: {{speed: 2.0}}}}'),
        _file(f'/**: {{ros__parameters: {{speed: 2.0}}}}\ncruiser: {{ros__parameters: {_HALF}}}'),
    ),
    'remap.unmatched': (_remap('/chater:=/other'), _remap('/chatter:=/other')),
    'remap.chain': (_remap('chatter:=news', 'news:=other'), _remap('chatter:=news')),
    'remap.other-node': (_remap('talkr:chatter:=/other'), _remap('talker:chatter:=/other')),
}
