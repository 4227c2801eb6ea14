"""The picture of a camera, live: `lab.image('/camera/image_raw')`.

An ordinary subscriber of a topic with `sensor_msgs/msg/Image`, of the simulated robot or of a real
one. The page gets the newest picture ten times a second at most, as a small JPEG; those in between
are not even looked at.
"""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

from labkit.errors import LabError
from labkit.views.feed import Feed, heard
from labkit.views.image_pixels import Picture, picture_of, to_jpeg, to_png
from labkit.views.live import helper
from labkit.views.live_page import LivePage, News

if TYPE_CHECKING:
    from sensor_msgs.msg import Image

__all__ = ['ImageView', 'image']

# How long a live view waits for the first picture, s: so that one is stored with the notebook.
FIRST_SEC = 1.0


class ImageView(LivePage):
    """A live view of the pictures on a topic, to be shown in a cell; see `image`.

    Attributes:
        topic: Full name of the topic.
    """

    _name = 'image'
    _period = 0.1

    def __init__(self, topic: str) -> None:
        self._feed = _feed(topic, self._take)
        self.topic = self._feed.topic
        self._last: bytes | None = None
        # Whether one has come since the page was told; why none comes; and what is wrong with it.
        self._is_new, self._why, self._wrong = False, '', ''
        super().__init__([self._feed])

    @property
    def count(self) -> int:
        """How many pictures have come while somebody looked on."""
        return self._feed.count

    @property
    def text(self) -> str:
        """What there is to see, in words."""
        if self._last is None:
            return f'No picture was heard on {self.topic} yet. {self._why}'.strip()
        try:
            return self._told_of(picture_of(_message(self._last)))
        except LabError as error:
            return f'{self.topic}: {error}'

    def __repr__(self) -> str:
        self._wait_for_first()
        return self.text

    def _still(self) -> dict[str, str]:
        if self._watched and not self._ended and self._node is None:
            self._open()
        self._wait_for_first()
        return self._stored_form()

    def _stored_form(self) -> dict[str, str]:
        shown = {'text/plain': self.text}
        if self._last is not None:
            try:
                png = to_png(picture_of(_message(self._last)))
            except LabError:
                return shown
            shown['image/png'] = base64.b64encode(png).decode()
        return shown

    def _told_of(self, picture: Picture) -> str:
        return f'Picture of {self.topic}: {picture.words}.'

    # -- ROS ------------------------------------------------------------------------------------

    def _take(self, data: bytes) -> None:
        self._last, self._is_new = data, True

    def _wait_for_first(self) -> None:
        """Give a topic that is published a moment to be heard."""
        if self._ended:
            return
        before = self._feed.count
        limit = {'timeout_sec': FIRST_SEC} if self._watched else {}
        with heard([self._feed], lambda: self._feed.count > before, **limit):
            self._why = self._feed.silence()

    # -- the page -------------------------------------------------------------------------------

    def _news(self, everything: bool) -> News:
        rate = self._feed.rate()
        state: dict[str, Any] = {
            'topic': self.topic,
            'rate': '' if rate is None else f'{rate:.2g}' if rate < 9.5 else f'{rate:.0f}',
        }
        buffers: list[bytes] = []
        if self._last is not None and (self._is_new or everything):
            self._is_new = False
            try:
                picture = picture_of(_message(self._last))
                state |= {'about': picture.words, 'text': self._told_of(picture)}
                buffers = [to_jpeg(picture)]
                self._wrong = ''
            except LabError as error:
                self._wrong = str(error)
        state['note'] = self._wrong or self._feed.silence()
        return self._new_of(state), buffers


def image(topic: str) -> ImageView:
    """Show the pictures of a camera, live: a topic with `sensor_msgs/msg/Image`.

    Colours, grey and depth are shown: rgb8, bgr8, rgba8, bgra8, mono8, mono16, 16UC1, 32FC1 and a
    few more. Of a depth, what is near is light. A page gets no more than 10 pictures a second, and
    none with more than 640 by 480 pixels.

    Args:
        topic: Name of the topic, such as `'/camera/image_raw'`. It need not exist yet.

    Returns:
        What a cell shows as a picture, and `print()` as text. `.close()` ends it.

    Raises:
        LabError: `topic` is no name of a topic.
    """
    return ImageView(topic)


def _feed(topic: str, take: Any) -> Feed:
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from sensor_msgs.msg import Image

    # Best effort hears every camera, whatever it offers, and only the newest picture is of use.
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)  # type: ignore[no-untyped-call]
    return Feed(topic, helper(), take, msg_type=Image, qos_profile=qos, raw=True)


def _message(data: bytes) -> Image:
    from rclpy.serialization import deserialize_message
    from sensor_msgs.msg import Image

    found: Image = deserialize_message(data, Image)
    return found
