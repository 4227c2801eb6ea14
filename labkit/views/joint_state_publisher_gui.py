"""Sliders for the joints of a robot: `lab.joint_state_publisher_gui()`."""

from __future__ import annotations

import math
from typing import Any

from labkit.background.nodes import node_exists
from labkit.background.runtime import runtime
from labkit.errors import LabError, did_you_mean, quoted
from labkit.programs.joint_state_publisher import JointStatePublisher, limits_of
from labkit.views.live_page import LivePage, Update

__all__ = ['JointSliders', 'joint_state_publisher_gui']

NOBODY = (
    'Nobody publishes a description yet. robot_state_publisher does: '
    'ros2 run robot_state_publisher robot_state_publisher FILE'
)


class JointSliders(LivePage):
    """A node that publishes the positions of sliders, to be shown in a cell.

    Attributes:
        node: The node; its `positions` are those of the sliders.
    """

    _name = 'joint_state_publisher_gui'
    _period = 0.1

    def __init__(self, urdf: str) -> None:
        runtime.start()
        # First: this closes the view of an earlier run of the cell.
        super().__init__()
        self.node = JointStatePublisher(urdf)
        runtime.add(self.node)
        # Even without a page: its node runs.
        self._start()

    def set(self, **positions: float) -> None:
        """Move joints, rad or m, as their sliders do; up to their limits.

        Raises:
            LabError: There is no such joint.
        """
        with self._lock:
            for name, position in positions.items():
                if name not in self.node.positions:
                    raise LabError(
                        f'There is no joint {quoted(name)} that can be moved.',
                        todo=did_you_mean(
                            name,
                            self.node.positions,
                            f'There are: {", ".join(self.node.positions) or "none yet"}.',
                        ),
                    )
                self._move(name, position)

    def _move(self, name: str, position: Any) -> None:
        assert self.node.description is not None
        lower, upper = limits_of(self.node.description.joints[name])
        self.node.positions[name] = min(max(float(position), lower), upper)

    def __repr__(self) -> str:
        rows = self._rows()
        if not rows:
            return NOBODY if self.node.description is None else 'No joint of this robot moves.'
        width = max(len(row['name']) for row in rows)
        return '\n'.join(
            f'{row["name"]:<{width}}  {row["position"]:8.3f} {row["unit"]:<3}  '
            f'({row["lower"]:.3g} to {row["upper"]:.3g})'
            for row in rows
        )

    def _rows(self) -> list[dict[str, Any]]:
        description = self.node.description
        if description is None:
            return []
        found = []
        for joint in description.free_joints:
            lower, upper = limits_of(joint)
            found.append(
                {
                    'name': joint.name,
                    'lower': lower,
                    'upper': upper,
                    'position': self.node.positions.get(joint.name, 0.0),
                    'unit': 'm' if joint.type == 'prismatic' else 'rad',
                }
            )
        return found

    def _static(self) -> dict[str, str]:
        return {'text/plain': repr(self)}

    def _update(self, everything: bool) -> Update:
        rows = self._rows()
        note = '' if rows else repr(self)
        return self._changes({'rows': rows, 'note': note}), []

    def _handle_request(self, content: dict[str, Any]) -> None:
        """Handle a slider that was moved, or the button that centres all."""
        if content.get('centre') and self.node.description is not None:
            for joint in self.node.description.free_joints:
                self.node.positions[joint.name] = self.node.zero_of(joint)
        name, position = content.get('name'), content.get('position')
        is_number = isinstance(position, (int, float)) and math.isfinite(position)
        if isinstance(name, str) and name in self.node.positions and is_number:
            self._move(name, position)
        self._send()

    def _why_stopped(self) -> str:
        words = super()._why_stopped()
        node = getattr(self, 'node', None)
        if not words and node is not None and not node_exists(node):
            words = 'The node of these sliders has ended. Run this cell to start it again.'
        return words

    def _end(self, words: str) -> None:
        super()._end(words)
        node = getattr(self, 'node', None)
        if node is not None and node_exists(node):
            entry = runtime.entry_of(node)
            if entry is not None:
                runtime.discard(entry)


def joint_state_publisher_gui(urdf: str = '') -> JointSliders:
    """Move the joints of a robot by sliders.

    A node `joint_state_publisher` publishes `joint_states` (sensor_msgs/msg/JointState) ten times
    a second, with the positions of the sliders, as the program of this name does. The robot is the
    one that is described on `robot_description`, which `robot_state_publisher` publishes.

    Args:
        urdf: The description, if nobody publishes one.

    Returns:
        Sliders in a cell. `.set(joint=0.5)` moves one, `.close()` ends it.

    Raises:
        LabError: The text is no description.
    """
    return JointSliders(urdf)
