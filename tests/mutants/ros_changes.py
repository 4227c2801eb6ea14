"""Changes that know ROS: timers, types, QoS, callbacks, and what a node does for how long."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from typing import TypeVar

from mutants.changes import Change, bodies

__all__ = ['free_constants', 'ros_changes']

Found = TypeVar('Found')
# What kind of change it is, and the changed tree.
_Changed = tuple[str, ast.Module]
# Where a call has its queue depth or QoS profile.
_QOS_AT = {'create_publisher': 2, 'create_subscription': 3}
_OTHER_TYPES = {
    'Int16': ('std_msgs.msg', 'Int32'),
    'String': ('std_msgs.msg', 'Int16'),
    'Empty': ('std_msgs.msg', 'Bool'),
    'Twist': ('geometry_msgs.msg', 'TwistStamped'),
    'Pose2D': ('geometry_msgs.msg', 'Pose'),
    'Odometry': ('geometry_msgs.msg', 'PoseStamped'),
    'LaserScan': ('sensor_msgs.msg', 'PointCloud2'),
}
# Signs to start, which come seldom: here the second call is the one that counts.
_SIGNS = ('Empty', 'Pose2D')
_QOS = 'from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy'
_BEST_EFFORT = 'QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)'
_TRANSIENT_LOCAL = 'QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)'


def free_constants(tree: ast.Module, task: str) -> set[int]:
    """Return the `id` of each constant of which a task says nothing.

    These are the depth of a queue, the words around a logged text, and the name of a node.

    Args:
        tree: A solution.
        task: What the notebook says of it; a name that is asked for stands in backticks.
    """
    free: set[int] = set()
    for call in _calls(tree):
        name = _name_of(call)
        if name in _QOS_AT:
            free.update(map(id, call.args[_QOS_AT[name] :]))
        if name in ('info', 'warning'):
            free.update(id(n) for n in ast.walk(call) if isinstance(n, ast.Constant))
        if name in ('__init__', 'Node'):
            free.update(id(n) for n in call.args[:1] if f'`{getattr(n, "value", "")}`' not in task)
    return free


def ros_changes(code: str) -> Iterator[Change]:
    """Give changes of a program with nodes, kind by kind."""
    for kind in (
        *(_timers, _depths, _qos, _types, _moved, _not_spun, _second_nodes, _node_names),
        *(_called, _early_returns, _limits, _two_messages),
    ):
        for name, tree in kind(code):
            yield name, ast.unparse(tree)


def _each(
    code: str, find: Callable[[ast.Module], list[Found]]
) -> Iterator[tuple[ast.Module, Found]]:
    """Give, for each thing that is found in a program, a tree of its own and that thing in it."""
    for i in range(len(find(ast.parse(code)))):
        tree = ast.parse(code)
        yield tree, find(tree)[i]


def _calls(tree: ast.AST, *names: str) -> list[ast.Call]:
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    return [call for call in calls if not names or _name_of(call) in names]


def _name_of(call: ast.Call) -> str:
    return str(getattr(call.func, 'attr', getattr(call.func, 'id', '')))


def _expression(text: str) -> ast.expr:
    return ast.parse(text, mode='eval').body


def _import(tree: ast.Module, line: str) -> None:
    tree.body[:0] = ast.parse(line).body


def _classes(tree: ast.Module) -> list[ast.ClassDef]:
    return [node for node in tree.body if isinstance(node, ast.ClassDef)]


def _methods(tree: ast.AST) -> list[ast.FunctionDef]:
    return [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]


def _timers(code: str) -> Iterator[_Changed]:
    for form in ('1 / {}', '1000 * {}', '0 * {}'):
        for new, call in _each(code, lambda tree: _calls(tree, 'create_timer')):
            call.args[0] = _expression(form.format(ast.unparse(call.args[0])))
            yield 'timer', new


def _depths(code: str) -> Iterator[_Changed]:
    for new, call in _each(code, lambda tree: _calls(tree, *_QOS_AT)):
        del call.args[_QOS_AT[_name_of(call)] :]
        yield 'depth', new


def _qos(code: str) -> Iterator[_Changed]:
    """Give QoS with which two ends do not match: those with which they do are as good."""
    for new, call in _each(code, lambda tree: _calls(tree, *_QOS_AT)):
        publishes = _name_of(call) == 'create_publisher'
        call.args[-1] = _expression(_BEST_EFFORT if publishes else _TRANSIENT_LOCAL)
        _import(new, _QOS)
        yield 'qos', new
    for new, call in _each(code, lambda tree: _calls(tree, *_QOS_AT)):
        if isinstance(call.args[-1], ast.Name):
            call.args[-1] = ast.Constant(10)
            yield 'qos', new


def _types(code: str) -> Iterator[_Changed]:
    for name, (module, other) in _OTHER_TYPES.items():

        def uses(tree: ast.Module, name: str = name) -> list[ast.Name]:
            return [n for n in ast.walk(tree) if isinstance(n, ast.Name) and n.id == name]

        new = ast.parse(code)
        everywhere = uses(new)
        for node in everywhere:
            node.id = other
        _import(new, f'from {module} import {other}')
        if everywhere:
            yield 'type', new
        for new, node in _each(code, uses):
            node.id = other
            _import(new, f'from {module} import {other}')
            yield 'type', new


def _published(tree: ast.Module) -> list[tuple[list[ast.stmt], int, list[ast.FunctionDef]]]:
    """Return where something is published: statements, index, and the methods of its class."""
    return [
        (body, i, _methods(owner))
        for owner in _classes(tree)
        for body in bodies(owner)
        for i, statement in enumerate(body)
        if isinstance(statement, ast.Expr)
        and ast.unparse(statement).startswith('self.publisher.publish(')
    ]


def _moved(code: str) -> Iterator[_Changed]:
    """Publish when the node is made, first in the callback, and outside of the condition."""
    for new, (body, i, methods) in _each(code, _published):
        statement = body[i]
        body[i : i + 1] = [ast.Pass()] if len(body) == 1 else []
        methods[0].body.append(statement)
        yield 'moved', new
    for new, (body, i, methods) in _each(code, _published):
        own = next(m for m in methods if any(body is other for other in bodies(m)))
        if body is not own.body or i:
            statement = body[i]
            body[i : i + 1] = [ast.Pass()] if len(body) == 1 else []
            own.body.insert(0, statement)
            yield 'moved', new
    for new, (body, i, methods) in _each(code, _published):
        own = next(m for m in methods if any(body is other for other in bodies(m)))
        if body is not own.body:
            statement = body[i]
            body[i : i + 1] = [ast.Pass()] if len(body) == 1 else []
            own.body.append(statement)
            yield 'moved', new


def _not_spun(code: str) -> Iterator[_Changed]:
    def spun(tree: ast.Module) -> list[tuple[ast.AST, str, ast.Call]]:
        fields = [(node, *field) for node in ast.walk(tree) for field in ast.iter_fields(node)]
        return [
            (node, name, value)
            for node, name, value in fields
            if isinstance(value, ast.Call) and _name_of(value) == 'spin'
        ]

    for new, (node, name, call) in _each(code, spun):
        setattr(node, name, call.args[0])
        yield 'not-spun', new


def _second_nodes(code: str) -> Iterator[_Changed]:
    """Start one more node of a class, under another name."""
    for new, call in _each(code, lambda tree: _calls(tree, 'spin')):
        made = call.args[0]
        if not isinstance(made, ast.Call) or ast.unparse(call.func) != 'lab.spin':
            continue
        text = ast.unparse(made)
        if made.args and isinstance(made.args[0], ast.Constant):
            again = text.replace(repr(made.args[0].value), repr(f'{made.args[0].value!s}_2'))
        else:
            again = f'type("Second", ({_name_of(made)},), {{}})({text.partition("(")[2]}'
            for cls in _classes(new):
                if cls.name == _name_of(made):
                    _name_by_class(cls)
        new.body += ast.parse(f'lab.spin({again})').body
        yield 'second-node', new


def _name_by_class(cls: ast.ClassDef) -> None:
    """Let a subclass of a node have a name of its own."""
    for call in _calls(cls, '__init__'):
        if call.args and isinstance(call.args[0], ast.Constant):
            own = repr(call.args[0].value)
            text = f'{own} if type(self).__name__ != "Second" else {own[:-1]}_2{own[-1]}'
            call.args[0] = _expression(text)


def _node_names(code: str) -> Iterator[_Changed]:
    def names(tree: ast.Module) -> list[ast.Constant]:
        first = [arg for call in _calls(tree, '__init__', 'Node') for arg in call.args[:1]]
        return [arg for arg in first if isinstance(arg, ast.Constant)]

    for new, name in _each(code, names):
        name.value = f'my {name.value!s}'
        yield 'node-name', new


def _callbacks(tree: ast.AST) -> list[tuple[ast.Call, int]]:
    """Return where methods are passed to timers and subscriptions: the call, and which place."""
    return [
        (call, i)
        for call in _calls(tree, 'create_timer', 'create_subscription')
        for i, arg in enumerate(call.args)
        if isinstance(arg, ast.Attribute) and ast.unparse(arg).startswith('self.')
    ]


def _called(code: str) -> Iterator[_Changed]:
    for new, (call, i) in _each(code, _callbacks):
        call.args[i] = ast.Call(call.args[i], [], [])
        yield 'called', new


def _early_returns(code: str) -> Iterator[_Changed]:
    for new, method in _each(code, _methods):
        # A node that is not set up is another mistake.
        at = 1 if method.name == '__init__' else 0
        method.body.insert(at, ast.Return())
        yield 'return', new


def _limits(code: str) -> Iterator[_Changed]:
    """Give nodes that fall silent, or fail, after some calls."""
    for end in ('return', "raise RuntimeError('enough')"):
        for new, (call, i) in _each(code, _callbacks):
            count = 1 if ast.unparse(call.args[0]) in _SIGNS else 10
            name = getattr(call.args[i], 'attr', '')
            owner = next(c for c in _classes(new) if any(call is n for n in ast.walk(c)))
            method = next((m for m in _methods(owner) if m.name == name), None)
            if method is not None:
                lines = f"self.calls = getattr(self, 'calls', 0) + 1\nif self.calls > {count}:"
                method.body[:0] = ast.parse(f'{lines}\n    {end}').body
                yield 'silent' if end == 'return' else 'raises', new


def _two_messages(code: str) -> Iterator[_Changed]:
    """Publish each message once more, by a publisher of its own."""
    for new, (body, i, methods) in _each(code, _published):
        made = [s for m in methods for s in m.body if _calls(s, 'create_publisher')]
        if made:
            text = ast.unparse(made[0]).replace('self.publisher', 'self.second', 1)
            methods[0].body += ast.parse(text).body
            again = ast.unparse(body[i]).replace('self.publisher', 'self.second', 1)
            body[i + 1 : i + 1] = ast.parse(again).body
            yield 'two-messages', new
