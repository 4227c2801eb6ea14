"""Parameters and remapping, see `labkit.silent.parameter_faults`."""


def _file(text: str, args: str = "cli_args=['--ros-args', '--params-file', 'p.yaml']") -> str:
    return (
        f"open('p.yaml', 'w').write({text!r})\n"
        f"n = Node('cruiser', {args}); n.declare_parameter('speed', 1.0); lab.spin(n)"
    )


def _remap(*rules: str, name: str = 'talker') -> str:
    args = [word for rule in rules for word in ('-r', rule)]
    return f"loud({name!r}, 'chatter', cli_args={['--ros-args', *args]!r})"


def _set_later(spoken: str) -> str:
    return (
        'class Cruiser(Node):\n'
        '    def __init__(self):\n'
        "        super().__init__('cruiser')\n"
        "        self.declare_parameter('speed', 1.0)\n"
        "        self.speed = self.get_parameter('speed').value\n"
        '        self.create_timer(0.1, self.tick)\n'
        '    def tick(self):\n'
        f'        heard({spoken})\n'
        "lab.spin(Cruiser()).set_parameters([Parameter('speed', value=2.0)])"
    )


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
    'parameters.read-once': (
        _set_later('self.speed'),
        _set_later("self.get_parameter('speed').value"),
    ),
    'remap.unmatched': (_remap('/chater:=/other'), _remap('/chatter:=/other')),
    'remap.chain': (_remap('chatter:=news', 'news:=other'), _remap('chatter:=news')),
    'remap.other-node': (_remap('talkr:chatter:=/other'), _remap('talker:chatter:=/other')),
}
