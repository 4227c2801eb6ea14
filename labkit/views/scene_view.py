"""What RViz shows, in a notebook: `lab.scene()`.

It is an ordinary subscriber: frames as tf2 hears them, and one display a topic of a type that it
knows. Python makes shapes of the messages (`labkit.views.scene_messages`) and tells where frames
are; the page draws them by WebGL (`scene_drawing.js`), and only when something has changed. Where
widgets can't run it is a picture (`labkit.views.scene_picture`).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from labkit.errors import LabError, quoted
from labkit.views import dock
from labkit.views.arena_picture import two
from labkit.views.feed import subscribed
from labkit.views.live import helper
from labkit.views.live_page import REFRESH_SEC, LivePage, Update
from labkit.views.placed_frames import PlacedFrames
from labkit.views.scene_displays import Display, TopicDisplay
from labkit.views.scene_picture import to_svg
from labkit.views.scene_things import Thing, short, told_to_page
from labkit.views.scene_topics import DISPLAYS, ImageDisplay, RobotDisplay, WorldDisplay

if TYPE_CHECKING:
    from labkit.sim.turtlebot import Turtlebot
    from labkit.sim.world import World
    from labkit.transforms.tree import Place, Tree

__all__ = ['SceneView', 'scene']

# The text changes no more often than this, s: a screen reader has to finish speaking it.
TEXT_SEC = 1.0
# How long a picture waits for the first message of a published topic, s.
FIRST_SEC = 3.0
# Frames that stand still if they are there, as RViz has it, and REP 105.
STANDING = ('map', 'odom')
GRID, AXES = 'grid', 'frames'
SCENE = 'The scene'
# Where robots say what they look like. Some begin when somebody subscribes; that they are there is
# known from what they say of their joints.
DESCRIPTION, JOINTS = 'robot_description', 'joint_states'
# Of more frames the text tells only how many.
MOST_TOLD = 12
EMPTY = (
    'Nothing is there to be drawn: no transform was heard on /tf or /tf_static. Start a robot '
    'with lab.spin(lab.Turtlebot()): it appears here.'
)


class SceneView(LivePage):
    """A scene in three dimensions, to be shown in a cell; see `scene`."""

    _name = 'scene'
    # Twenty pictures a second; a page without a graphics card draws no more.
    _period = 0.05

    def __init__(
        self,
        *,
        fixed_frame: str,
        follow: str,
        show: tuple[str, ...],
        hide: tuple[str, ...],
        world: Callable[[], World] | None,
    ) -> None:
        self._wanted, self._follow = fixed_frame, follow
        self._chosen = dict.fromkeys(show, True) | dict.fromkeys(hide, False)
        self._frames = PlacedFrames(helper())
        self._displays: list[Display] = [Display(GRID), Display(AXES)]
        if world is not None:
            self._displays.append(WorldDisplay(world))
        for display in self._displays:
            display.is_on = self._chosen.get(display.name, True)
        super().__init__(self._frames.heard.feeds)
        self._found_at = self._text_sent_at = 0.0
        self._fresh = True
        # What the page has of each thing.
        self._sent: dict[str, Thing] = {}
        self._find_displays()

    # -- for cells ------------------------------------------------------------------------------

    @property
    def things(self) -> dict[str, Thing]:
        """The shapes that are drawn, by display and name."""
        with self._lock:
            return self._look()[1]

    @property
    def fixed_frame(self) -> str:
        """The frame that stands still; '' if there is none yet."""
        return self._wanted or _standing(self._frames.heard.tree)

    @property
    def text(self) -> str:
        """The scene in words."""
        with self._lock:
            return '\n'.join(self._told(self._look()[0]))

    def __repr__(self) -> str:
        self._wait_for_first()
        return self.text

    def _static(self) -> dict[str, str]:
        if self._watched and not self._ended and self._node is None:
            # Before the page asks: it can't while the cell is running and driving the robot.
            self._open()
        self._wait_for_first()
        return self._stored_form()

    def _stored_form(self) -> dict[str, str]:
        with self._lock:
            places, things = self._look()
            text = '\n'.join(self._told(places))
            if not places:
                return {'text/plain': text}
            grid, axes = (self._is_on(name) for name in (GRID, AXES))
            picture = to_svg(
                things.values(), places, text, follow=self._follow, axes=axes, grid=grid
            )
            return {'text/plain': text, 'image/svg+xml': picture}

    # -- what there is --------------------------------------------------------------------------

    def _look(self) -> tuple[dict[str, Place], dict[str, Thing]]:
        """Return where each frame is in the fixed frame, and the shapes that are drawn."""
        fixed, frames = self.fixed_frame, self._frames
        frames.why.clear()
        names = _ordered(frames.heard.tree) if fixed else []
        if names and fixed not in frames.heard.tree:
            frames.place(SCENE, fixed, names[0])
            names = []
        found = {name: frames.place(f'Frame {name}', fixed, name) for name in names}
        places = {name: place[1] for name, place in found.items() if place is not None}
        things = {
            f'{display.name} {name}': thing
            for display in self._displays
            for name, thing in display.things(frames, fixed).items()
        }
        return places, things

    def _is_on(self, name: str) -> bool:
        return any(display.is_on for display in self._displays if display.name == name)

    def _told(self, places: dict[str, Place]) -> list[str]:
        """Return what is drawn in words, and what is not, with the reason."""
        if not self._frames.heard.tree.names():
            silent = [feed.silence() for feed in self._frames.heard.feeds if feed.publishers]
            return [' '.join(filter(None, silent)) or EMPTY]
        told = [f'A scene in the frame {self.fixed_frame}.']
        if self.fixed_frame not in self._frames.heard.tree:
            # Nothing can be drawn, and all for one reason.
            return [*told, self._frames.why[SCENE]]
        for robot in self._robots(places):
            space = robot.name.removesuffix(DESCRIPTION).strip('/')
            x, y = (two(number) for number in places[robot.root][0][:2])
            told.append(f'{space or "Robot"} at x = {x} m, y = {y} m.')
        told += filter(None, (display.words() for display in self._displays))
        names = list(places)
        shown = ', '.join(names) if len(names) <= MOST_TOLD else str(len(names))
        told.append(f'Frames: {shown}.')
        return [*told, *self._frames.why.values()]

    def _robots(self, places: dict[str, Place]) -> list[RobotDisplay]:
        """Return the robots that are drawn."""
        found = (one for one in self._displays if isinstance(one, RobotDisplay) and one.is_on)
        return [robot for robot in found if robot.root in places]

    # -- ROS ------------------------------------------------------------------------------------

    def _wait_for_first(self) -> None:
        """Give published topics a moment to deliver, so that there is a picture."""
        if self._ended:
            return
        with self._lock:
            self._find_displays()
            heard, topics = self._frames.heard, self._topics()
            if self._node is None:
                heard.node = helper()
                heard.forget()
                for display in topics:
                    display.forget()

        def enough() -> bool:
            return heard.is_complete() and all(
                display.is_heard or not display.is_awaited for display in topics if display.is_on
            )

        feeds = [*heard.feeds, *(display.feed for display in topics if display.is_on)]
        with subscribed(feeds, enough, timeout_sec=FIRST_SEC):
            pass

    def _topics(self) -> list[TopicDisplay]:
        return [display for display in self._displays if isinstance(display, TopicDisplay)]

    def _open(self) -> None:
        with self._lock:
            if self._node is None:
                self._frames.heard.begin()
            super()._open()

    def _tick(self) -> None:
        self._frames.heard.follow_publishers()
        if time.monotonic() - self._found_at >= REFRESH_SEC:
            self._find_displays()
        super()._tick()

    def _find_displays(self) -> None:
        """Add a display for each topic of a known type, and take away those that have gone."""
        self._found_at = time.monotonic()
        node = helper()
        topics: dict[str, type[TopicDisplay]] = {}
        for topic, types in node.get_topic_names_and_types():
            if len(types) == 1 and node.count_publishers(topic):
                space, _, end = topic.rpartition('/')
                if end in (DESCRIPTION, JOINTS):
                    topics[f'{space}/{DESCRIPTION}'] = RobotDisplay
                elif types[0] in DISPLAYS:
                    topics[topic] = DISPLAYS[types[0]]
        known = {display.name: display for display in self._topics()}
        for topic, display in known.items():
            if topic not in topics:
                self._displays.remove(display)
                self._let_listen(display, listen=False)
        for topic in sorted(topics.keys() - known.keys()):
            kind = topics[topic]
            display = kind(topic, is_on=self._chosen.get(topic, kind.at_first))
            self._displays.append(display)
            self._let_listen(display, listen=display.is_on)

    def _let_listen(self, display: TopicDisplay, *, listen: bool) -> None:
        """Subscribe to the topic of a display while the view is open, or not any more."""
        if listen and display.feed not in self._feeds:
            self._feeds.append(display.feed)
            if self._node is not None:
                display.feed.open(self._node)
        elif not listen and display.feed in self._feeds:
            self._feeds.remove(display.feed)
            display.feed.close()
            display.forget()

    # -- the page -------------------------------------------------------------------------------

    def _handle_request(self, content: dict[str, Any]) -> None:
        """Handle the wish for a panel, a display that is switched, or another fixed frame."""
        name, is_on, fixed = content.get('display'), content.get('on'), content.get('fixed')
        if content.get('dock'):
            dock.show_cell(self)
        elif isinstance(name, str) and isinstance(is_on, bool):
            self._chosen[name] = is_on
            for display in self._displays:
                if display.name == name:
                    display.is_on = is_on
                    if isinstance(display, TopicDisplay):
                        self._let_listen(display, listen=is_on)
        elif isinstance(fixed, str) and fixed in self._frames.heard.tree:
            self._wanted = fixed
        self._text_sent_at = 0.0

    def _update(self, everything: bool) -> Update:
        now = time.monotonic()
        places, things = self._look()
        why = self._frames.why
        state: dict[str, object] = {
            'fixed': self.fixed_frame,
            'frames': {name: short(place) for name, place in places.items()},
            'follow': self._follow,
            'robots': [robot.root for robot in self._robots(places)],
            'displays': [[one.name, one.is_on, why.get(one.name, '')] for one in self._displays],
        }
        if everything or now - self._text_sent_at >= TEXT_SEC:
            self._text_sent_at = now
            told = self._told(places)
            empty = EMPTY if told == [EMPTY] else ''
            state |= {'text': '' if empty else '\n'.join(told), 'empty': empty}
        if everything:
            self._sent = {}
        buffers: list[bytes] = []
        changes = self._changes(state)
        new = {name: thing for name, thing in things.items() if self._sent.get(name) is not thing}
        gone = dict.fromkeys(self._sent.keys() - things.keys())
        self._sent = things
        if new or gone:
            told_things = {name: told_to_page(thing, buffers) for name, thing in new.items()}
            changes['things'] = told_things | gone
        pictures = {}
        for display in self._displays:
            if isinstance(display, ImageDisplay):
                jpeg = display.picture(again=everything)
                if jpeg is not None:
                    pictures[display.name] = len(buffers)
                    buffers.append(jpeg)
        if pictures:
            changes['pictures'] = pictures
        if everything:
            # Scroll to the view only when its cell was just run.
            changes['fresh'], self._fresh = self._fresh, False
        return changes, buffers


def _standing(tree: Tree) -> str:
    """Return the frame that stands still if nobody names one: a map, odometry, or a root."""
    names = tree.names()
    known = next((name for name in STANDING if name in names), '')
    if known or not names:
        return known
    held = {edge.child for edge in tree.edges()}
    return next((name for name in names if name not in held), names[0])


def _ordered(tree: Tree) -> list[str]:
    """Return all frames, those near a root first."""
    parents = {edge.child: edge.parent for edge in tree.edges()}

    def depth(name: str) -> int:
        met = {name}
        while (name := parents.get(name, '')) and name not in met:
            met.add(name)
        return len(met)

    return sorted(tree.names(), key=lambda name: (depth(name), name))


def scene(
    *,
    fixed_frame: str | None = None,
    follow: str | None = None,
    show: Iterable[str] = (),
    hide: Iterable[str] = (),
    world: World | Turtlebot | None = None,
) -> SceneView:
    """Show robots and what they see in three dimensions, live, as RViz does.

    It draws what is published: the frames that tf2 hears as axes with names, robots by their
    `robot_description`, and each topic of laser scans, paths, odometry, poses such as goals, or
    markers. What tf2 can't place is left out, and named with its reason.

    Mouse, touch, keys and buttons turn it, move it and come nearer. In its list of displays
    topics are switched on and off, and the frame that stands still, or is followed, is chosen.
    A topic that is off is not subscribed to. The button Dock is `lab.dock()`.

    Args:
        fixed_frame: The frame that stands still; by default `map`, `odom`, or the root of the
            tree.
        follow: The frame that stays in the middle.
        show: Topics, or other displays, that are on from the start: those of cameras are off by
            default, since a camera takes time.
        hide: Topics, or other displays, that are off from the start.
        world: The world of a simulator, or a robot in it: its walls, posts and crates are drawn,
            which no topic tells.

    Returns:
        A scene in a cell, text for `print()`. `.close()` ends it.

    Raises:
        LabError: A frame or a topic is no name, or `world` is no world.
        ImportError: The type of transforms can't be built here.
    """
    fixed, followed = _checked([fixed_frame or '', follow or ''])
    return SceneView(
        fixed_frame=fixed,
        follow=followed,
        show=_checked(show),
        hide=_checked(hide),
        world=_world_of(world),
    )


def _checked(names: Iterable[str]) -> tuple[str, ...]:
    """Return names of frames, topics or displays."""
    every = () if isinstance(names, str) else tuple(names)
    if isinstance(names, str) or not all(isinstance(name, str) for name in every):
        raise LabError(
            f'show and hide are lists of names, and frames are names, but got {quoted(names)}.',
            todo="Write them like this: lab.scene(fixed_frame='odom', hide=['/odom', 'frames'])",
        )
    return every


def _world_of(world: object) -> Callable[[], World] | None:
    """Return what returns a simulated world, or that of a robot, as it is now; None for none."""
    from labkit.sim.world import World

    if world is None:
        return None
    simulator = getattr(world, 'simulator', None)
    if isinstance(getattr(simulator, 'world', None), World):
        return lambda: simulator.world  # type: ignore[union-attr]
    if isinstance(getattr(world, 'plan', None), World):
        return world.seen  # type: ignore[attr-defined, no-any-return]
    if isinstance(world, World):
        return lambda: world
    raise LabError(
        f'world is a simulated world, or a robot in one, but it is {quoted(world)}.',
        todo='robot = lab.spin(lab.Turtlebot()), then lab.scene(world=robot)',
    )
