"""The tree of frames as tf2 hears it, live: `lab.frames()`."""

from __future__ import annotations

from typing import Any

from labkit.errors import LabError, did_you_mean, quoted
from labkit.transforms.exceptions import TransformException
from labkit.views.feed import subscribed
from labkit.views.frames_heard import HeardFrames
from labkit.views.frames_picture import FramesPicture, below_name, parts
from labkit.views.frames_tree import FrameChain, FrameEdge, FrameTree
from labkit.views.graph_flow import in_hertz
from labkit.views.live import helper
from labkit.views.live_page import LivePage, Update
from labkit.views.svg_drawing import WIDTH, caption_lines, fitting

__all__ = ['Frames', 'frames']

EMPTY = (
    'No transform was heard on /tf or /tf_static. Start a robot with lab.spin(lab.Turtlebot()), '
    'or publish one with a tf2_ros.TransformBroadcaster: it appears here.'
)


class Frames(LivePage):
    """The tree of frames, to be shown in a cell; see `frames`."""

    _name = 'frames'
    _called = 'tree of frames'
    # Faster changes can't be read.
    _period = 0.5

    def __init__(self, names: tuple[str, ...]) -> None:
        self._names = names
        self._heard = HeardFrames(helper())
        self._width = WIDTH
        # What is drawn in the page, and the drawing.
        self._drawn: tuple[object, ...] = ()
        self._picture = FramesPicture(FrameTree())
        super().__init__(self._heard.feeds)

    @property
    def data(self) -> FrameTree:
        """The tree as data."""
        return self._heard.found()

    def __repr__(self) -> str:
        self._wait_for_first()
        return self._static()['text/plain']

    # -- stored ---------------------------------------------------------------------------------

    def _static(self) -> dict[str, str]:
        self._wait_for_first()
        return self._stored_form()

    def _stored_form(self) -> dict[str, str]:
        tree = self._heard.found()
        if not tree.edges:
            return {'text/plain': '\n'.join([self._silence(), *map(str, tree.troubles)])}
        chain, why = self._chain()
        text = str(chain) if chain is not None else '\n'.join(filter(None, [why, str(tree)]))
        return {'text/plain': text, 'image/svg+xml': FramesPicture(tree, chain, why).svg()}

    def _wait_for_first(self) -> None:
        """Give published frames a moment to arrive."""
        if self._ended or self._node is not None:
            return
        self._heard.node = helper()
        self._heard.forget()
        with subscribed(self._feeds, self._heard.is_complete):
            pass

    def _silence(self) -> str:
        published = [feed for feed in self._feeds if feed.publishers]
        return ' '.join(filter(None, (feed.silence() for feed in published))) or EMPTY

    def _chain(self) -> tuple[FrameChain | None, str]:
        """Return the way that was asked for, or why there is none; nothing for the whole tree."""
        if not self._names:
            return None, ''
        target, source = self._names if len(self._names) == 2 else ('', *self._names)
        try:
            return self._heard.chain(target, source), ''
        except TransformException as error:
            known = self._heard.tree.names()
            unknown = [name for name in (target, source) if name and name not in known]
            guess = did_you_mean(unknown[0], known) if unknown else ''
            return None, ' '.join(filter(None, [str(error).strip(), guess]))

    # -- the page -------------------------------------------------------------------------------

    def _open(self) -> None:
        with self._lock:
            if self._node is None:
                self._heard.begin()
            super()._open()

    def _tick(self) -> None:
        if self._heard.follow_publishers():
            return  # what is there comes again at once
        super()._tick()

    def _handle_request(self, content: dict[str, Any]) -> None:
        if isinstance(content.get('width'), (int, float)):
            self._width = fitting(content['width'])
            self._send(everything=True)

    def _update(self, everything: bool) -> Update:
        tree = self._heard.found()
        chain, why = self._chain() if tree.edges else (None, '')
        drawn = (tree, chain.edges if chain is not None else (), why, self._width)
        told = '' if tree.edges else self._silence()
        is_empty = told == EMPTY
        state: dict[str, Any] = {'note': '' if is_empty else told, 'empty': EMPTY * is_empty}
        if everything or drawn != self._drawn:
            self._drawn = drawn
            self._picture = picture = FramesPicture(tree, chain, why, self._width)
            state |= {
                'svg': picture.svg() if tree.edges else '',
                'parts': parts(picture, tree),
                'told': picture.told,
            }
        if chain is not None:
            state['caption'] = [line for line, _ in caption_lines([chain.result], self._width)]
        small, rates = {}, {}
        for number, edge in self._picture.edges.items():
            pace = self._pace(edge)
            small[f'b{number}'] = below_name(edge, chain, pace)
            rates[f'b{number}'] = pace
        return self._changes(state | {'small': small, 'rates': rates}), []

    def _pace(self, edge: FrameEdge) -> str:
        """Return how often a frame comes and how old it is, in words; '' for a static one."""
        pace = self._heard.pace(edge.parent, edge.child)
        if pace is None:
            return ''
        rate, age = pace
        return f'{in_hertz(rate) or "silent"}, {_seconds(age)} old'


def frames(*names: str) -> Frames:
    """Show the tree of frames: where things are, who says so, how often, and how old it is.

    It is what a listener of tf2 hears on `/tf` and `/tf_static`. Parents lead to the frames that
    are given in them. A frame that moves is round, a static one is a box; each says which node
    publishes it. What is wrong is marked and told, as far as there are words of tf2 in those: a
    tree that is cut, a loop, a transform that it does not take; and a frame that has two parents,
    or that two nodes publish.

    With two frames it shows the way between them, with numbers: where the second one is in the
    first one, as `lookup_transform` says it, in metres and degrees. With one frame, where that is
    in the root of its tree.

    In JupyterLab the picture is live, with the rate of each moving frame and the age of its newest
    transform. Each part tells more when it is pointed at, or reached with Tab and the arrow keys.
    It listens while it is visible; a simulated robot begins to publish its frames then.

    Args:
        names: None for all frames; or a frame; or two, the target and the source.

    Returns:
        A picture in a cell, text for `print()`. `.data` is the tree as data, and `.close()` ends a
        live picture.

    Raises:
        LabError: There are more than two names, or one is no text.
        ImportError: The type of transforms can't be built here.
    """
    if len(names) > 2 or not all(isinstance(name, str) for name in names):
        raise LabError(
            f'lab.frames takes up to two names of frames, but got {quoted(names)}.',
            todo="lab.frames() shows all; lab.frames('odom', 'base_scan') the way between two.",
        )
    return Frames(names)


def _seconds(age: float) -> str:
    return f'{age:.2f} s' if abs(age) < 1 else f'{age:.1f} s' if abs(age) < 10 else f'{age:.0f} s'
