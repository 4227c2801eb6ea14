"""A program in a notebook: from its `rclpy.init()` to its `rclpy.shutdown()`.

A tutorial's program expects a process of its own: what it passes to `init` is about its nodes, and
`shutdown` ends these. Other cells' nodes are in the same process, but not in the program.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any
from weakref import WeakSet

import rclpy.logging
from rclpy.context import Context
from rclpy.node import Node

from labkit.background.nodes import existing_nodes
from labkit.errors import LabError, quoted
from labkit.rosgraph.yaml_loading import load_yaml_file

__all__ = ['Arguments', 'Program', 'look_at_files', 'renamed']

_FOR_NODES = ('-r', '--remap', '-p', '--param', '--params-file')
_FOR_PROCESS = ('-e', '--enclave', '--log-config-file', '--log-file-name')
# What holds in a notebook anyway.
_DEFAULTS = ('--enable-rosout-logs', '--enable-stdout-logs', '--disable-external-lib-logs')


@dataclass
class Arguments:
    """What `rclpy.init(args=...)` says to ROS.

    Attributes:
        for_nodes: Rules and parameters, for nodes made afterwards.
        for_process: What rcl applies only when ROS starts.
        level: Log level of nodes made afterwards, None for the default.
        levels: Log levels of loggers, by name.
        rosout: Whether log messages go to `/rosout`.
    """

    for_nodes: list[str] = field(default_factory=list)
    for_process: list[str] = field(default_factory=list)
    level: str | None = None
    levels: dict[str, str] = field(default_factory=dict)
    rosout: bool = True

    @classmethod
    def read(cls, args: Sequence[str] | None) -> Arguments:
        """Sort command line arguments; those outside of `--ros-args ... --` say nothing to ROS."""
        found, inside = cls(), False
        words = iter(args or ())
        for word in words:
            if word in ('--', '--ros-args'):
                inside = word == '--ros-args'
            elif not inside or word in _DEFAULTS:
                continue
            elif word == '--log-level':
                name, _, level = next(words, '').rpartition(':=')
                if name:
                    found.levels[name] = level
                else:
                    found.level = level
            elif word == '--disable-rosout-logs':
                found.rosout = False
            elif word in _FOR_PROCESS or re.match('--(en|dis)able-', word):
                found.for_process += [word, *([next(words, '')] * (word in _FOR_PROCESS))]
            else:
                found.for_nodes += [word, *([next(words, '')] * (word in _FOR_NODES))]
        return found


def look_at_files(args: Sequence[str]) -> None:
    """Raise LabError for a parameter file that cannot be read: rcl hangs over a pipe."""
    for option, path in pairwise(args):
        if option != '--params-file' or not os.path.exists(path):
            continue
        try:
            load_yaml_file(path)
        except (OSError, ValueError) as error:
            why = error.strerror if isinstance(error, OSError) else error
            raise LabError(
                f'The arguments name a parameter file that cannot be read, {quoted(path)}: {why}.',
                todo='Name a YAML file with parameters.',
            ) from error


class Program:
    """One program.

    Args:
        args: What it has passed to `rclpy.init`.
        request_id: The execution of the cell that has called `rclpy.init`.
        started_at: When ROS was started, see `Runtime`.

    Attributes:
        ended_in: The execution of the cell in which it has called `rclpy.shutdown`, None before.
        left_in: The one of a node of its own that has called it in a callback, None before.

    Raises:
        RuntimeError: rcl does not understand the arguments.
    """

    def __init__(self, args: Sequence[str] | None, request_id: str, started_at: float) -> None:
        if args:
            # rcl judges them where it makes a context of them.
            judge = Context()
            judge.init(list(args), initialize_logging=False, domain_id=0)
            judge.shutdown()
        self.request_id = request_id
        self.started_at = started_at
        self.ended_in: str | None = None
        self.left_in: str | None = None
        self._args = Arguments.read(args)
        self._before = WeakSet(existing_nodes())
        self._loggers: list[str] = []
        for name, level in self._args.levels.items():
            self._set_level(name, level)

    @property
    def for_nodes(self) -> tuple[str, ...]:
        """The rules and parameters for its nodes."""
        return tuple(self._args.for_nodes)

    def made(self, node: Node) -> bool:
        """Return whether a node was made since the program has begun."""
        return node not in self._before

    def options(self, given: dict[str, Any]) -> dict[str, Any]:
        """Return the keyword arguments of a new node, with what `rclpy.init` was told added."""
        if not given.get('use_global_arguments', True):
            return given
        options = dict(given)
        if self._args.for_nodes:
            own = given.get('cli_args') or ()
            options['cli_args'] = [*own, '--ros-args', *self._args.for_nodes]
        if not self._args.rosout:
            options['enable_rosout'] = False
        return options

    def set_level(self, node: Node) -> None:
        """Set the log level of a new node."""
        if self._args.level is not None:
            logger = node.get_logger()  # type: ignore[no-untyped-call]
            self._set_level(logger.name, self._args.level)

    def forget_levels(self) -> None:
        """Set the log levels back that this program has set."""
        for name in self._loggers:
            rclpy.logging.set_logger_level(name, rclpy.logging.LoggingSeverity.UNSET)

    def _set_level(self, name: str, level: str) -> None:
        severity = rclpy.logging.get_logging_severity_from_string(level)
        rclpy.logging.set_logger_level(name, severity)
        self._loggers.append(name)


def renamed(name: str, namespace: str, cli_args: Sequence[str]) -> tuple[str, str]:
    """Return the name and namespace that a node has with its command line arguments."""
    found = {'node': name, 'ns': namespace}
    left = {'node', 'ns'}  # the first rule for each counts
    for flag, rule in pairwise(cli_args):
        match = re.fullmatch(r'(?:([^:]+):)?__(node|name|ns):=(.*)', rule)
        if flag not in ('-r', '--remap') or match is None or match[1] not in (None, name):
            continue
        kind = 'ns' if match[2] == 'ns' else 'node'
        if kind in left:
            left.discard(kind)
            found[kind] = match[3]
    return found['node'], found['ns']
