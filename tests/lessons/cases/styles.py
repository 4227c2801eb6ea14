"""Other styles in which each solution may be written, made from it: all of them are right."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from rclpy.node import Node

__all__ = ['callbacks_otherwise', 'composed', 'own_executor']

# The makers of what has a callback, and the place of that among their arguments.
_CALLBACK_AT = {'create_timer': 1, 'create_subscription': 2, 'create_service': 2}
_GROUPED = (*_CALLBACK_AT, 'create_client', 'ActionServer', 'ActionClient')
# The makers of what has a name in the graph, and the place of that.
_TOPIC_AT = {'create_publisher': 1, 'create_subscription': 1}
# What is made of a node, and the place of that.
_NODE_AT = {
    **dict.fromkeys(('ActionServer', 'ActionClient'), 0),
    **dict.fromkeys(('StaticTransformBroadcaster', 'TransformBroadcaster'), 0),
    'TransformListener': 1,
}

_ENDLESS = """
def endless(callback):
    while True:
        callback()
        yield
"""
_SPIN = """
def spin(thing):
    lab.spin(thing.node)
    return thing
"""
_EXECUTOR = """
def run(node):
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()
    return node
"""


def own_executor(code: str) -> Iterator[str]:
    """Give the program with an executor of its own in a thread, and a node that helps it."""
    if 'lab.spin(' in code:
        imports = 'import threading\nfrom rclpy.executors import SingleThreadedExecutor\n'
        imports += 'from rclpy.node import Node\n'
        code = code.replace('lab.spin(', 'run(')
        yield f'{imports}{_EXECUTOR}{code}\nhelper = run(Node("helper"))\n'


def callbacks_otherwise(code: str) -> Iterator[str]:
    """Give the program with coroutines, partials, generators and groups for its callbacks."""
    tree = ast.parse(code)
    calls = [(call, _name(call)) for call in ast.walk(tree) if isinstance(call, ast.Call)]
    called = {call.func.attr for call, _ in calls if isinstance(call.func, ast.Attribute)}
    methods = {n.name: n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)}
    made = False
    for call, name in calls:
        if name in _GROUPED and not any(each.arg == 'callback_group' for each in call.keywords):
            call.keywords.append(
                ast.keyword('callback_group', _parsed('ReentrantCallbackGroup()'))
            )
            made = True
        place = _CALLBACK_AT.get(name, 9)
        callback = call.args[place] if len(call.args) > place else None
        if not isinstance(callback, ast.Attribute) or callback.attr not in methods:
            continue
        method = methods[callback.attr]
        if name == 'create_timer':
            made_of = f'partial(next, endless({ast.unparse(callback)}))'
        elif name == 'create_subscription' and callback.attr not in called:
            index = next(i for b in _bodies(tree) for i, n in enumerate(b) if n is method)
            body = next(b for b in _bodies(tree) if method in b)
            body[index] = ast.AsyncFunctionDef(**vars(method))
            methods.pop(callback.attr)
            made_of = ast.unparse(callback)
        else:
            made_of = f'partial({ast.unparse(callback)})'
        call.args[place] = _parsed(made_of)
    if made:
        imports = 'from functools import partial\n'
        imports += 'from rclpy.callback_groups import ReentrantCallbackGroup\n'
        yield f'{imports}{_ENDLESS}{ast.unparse(ast.fix_missing_locations(tree))}'


def composed(code: str) -> Iterator[str]:
    """Give the program with a class that has a node and is none, and a topic that is remapped."""
    tree = ast.parse(code)
    for kind in (n for n in tree.body if isinstance(n, ast.ClassDef)):
        own = {n.name for n in kind.body if isinstance(n, ast.FunctionDef)} - {'__init__'}
        if [ast.unparse(base) for base in kind.bases] != ['Node'] or own & {*dir(Node)}:
            return
        kind.bases = []
        _Composer(own).visit(kind)
    if any(isinstance(n, ast.ClassDef) for n in tree.body):
        program = ast.unparse(ast.fix_missing_locations(tree))
        yield f'{_SPIN}{program.replace("lab.spin(", "spin(")}'


class _Composer(ast.NodeTransformer):
    def __init__(self, own: set[str]) -> None:
        self._own = own
        self._arguments = ast.List([], ast.Load())

    def visit_Call(self, call: ast.Call) -> ast.AST:
        name, place = _name(call), _TOPIC_AT.get(_name(call), 9)
        if ast.unparse(call.func) == 'super().__init__':
            call.func = ast.Name('Node', ast.Load())
            call.keywords.append(ast.keyword('cli_args', self._arguments))
            return ast.Assign([_parsed('self.node')], call)
        topic = call.args[place] if len(call.args) > place else None
        if isinstance(topic, ast.Constant) and isinstance(topic.value, str):
            mine, told = f'my_{topic.value.strip("/")}', topic.value
            topic.value = mine
            words = [] if self._arguments.elts else ['--ros-args']
            self._arguments.elts += map(ast.Constant, [*words, '-r', f'{mine}:={told}'])
        if name in _NODE_AT and ast.unparse(call.args[_NODE_AT[name]]) == 'self':
            call.args[_NODE_AT[name]] = _parsed('self.node')
        return self.generic_visit(call)

    def visit_Expr(self, line: ast.Expr) -> ast.AST:
        made = self.visit(line.value)
        return made if isinstance(made, ast.Assign) else ast.Expr(made)

    def visit_Attribute(self, attribute: ast.Attribute) -> ast.AST:
        self.generic_visit(attribute)
        of_self = ast.unparse(attribute.value) == 'self' and attribute.attr not in self._own
        if of_self and hasattr(Node, attribute.attr):
            attribute.value = _parsed('self.node')
        return attribute


def _bodies(tree: ast.AST) -> Iterator[list[ast.stmt]]:
    yield from (n.body for n in ast.walk(tree) if isinstance(n, (ast.Module, ast.ClassDef)))


def _name(call: ast.Call) -> str:
    return str(getattr(call.func, 'attr', getattr(call.func, 'id', '')))


def _parsed(text: str) -> ast.expr:
    return ast.parse(text, mode='eval').body
