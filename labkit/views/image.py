"""A live camera image: `lab.image('/camera/image_raw')`.

An ordinary subscriber of `sensor_msgs/msg/Image`, for the simulated robot or a real one. The page
gets the newest image at most ten times a second, as a small JPEG; those in between are not
decoded.
"""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

from labkit.errors import LabError
from labkit.views.feed import Feed, subscribed
from labkit.views.image_pixels import Picture, picture_of, to_jpeg, to_png
from labkit.views.live import helper
from labkit.views.live_page import LivePage, Update

if TYPE_CHECKING:
    from sensor_msgs.msg import Image

__all__ = ['ImageView', 'image']

# How long a live view waits for the first image, so that one is stored with the notebook, s.
FIRST_SEC = 1.0


class ImageView(LivePage):
    """A live view of the images on a topic, to be shown in a cell; see `image`.

    Attributes:
        topic: Full name of the topic.
    """

    _name = 'image'
    _period = 0.1

    def __init__(self, topic: str) -> None:
        self._feed = _feed(topic, self._on_image)
        self.topic = self._feed.topic
        self._last: bytes | None = None
        # Whether an image is unsent; why none arrives; what is wrong with the last one.
        self._is_new, self._why, self._wrong = False, '', ''
        super().__init__([self._feed])

    @property
    def count(self) -> int:
        """Number of images received while the view was visible."""
        return self._feed.count

    @property
    def text(self) -> str:
        """The image in words."""
        if self._last is None:
            return f'No picture was heard on {self.topic} yet. {self._why}'.strip()
        try:
            return self._describe(picture_of(_message(self._last)))
        except LabError as error:
            return f'{self.topic}: {error}'

    def __repr__(self) -> str:
        self._wait_for_first()
        return self.text

    def _static(self) -> dict[str, str]:
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

    def _describe(self, picture: Picture) -> str:
        return f'Picture of {self.topic}: {picture.words}.'

    # -- ROS ------------------------------------------------------------------------------------

    def _on_image(self, data: bytes) -> None:
        self._last, self._is_new = data, True

    def _wait_for_first(self) -> None:
        """Give a published topic a moment to deliver."""
        if self._ended:
            return
        before = self._feed.count
        limit = {'timeout_sec': FIRST_SEC} if self._watched else {}
        with subscribed([self._feed], lambda: self._feed.count > before, **limit):
            self._why = self._feed.silence()

    # -- the page -------------------------------------------------------------------------------

    def _update(self, everything: bool) -> Update:
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
                state |= {'about': picture.words, 'text': self._describe(picture)}
                buffers = [to_jpeg(picture)]
                self._wrong = ''
            except LabError as error:
                self._wrong = str(error)
        state['note'] = self._wrong or self._feed.silence()
        return self._changes(state), buffers


def image(topic: str) -> ImageView:
    """Show a camera's images, live: a topic with `sensor_msgs/msg/Image`.

    Colour, grey and depth images work: rgb8, bgr8, rgba8, bgra8, mono8, mono16, 16UC1, 32FC1 and a
    few more. In a depth image, near is light. A page gets at most 10 images a second, of at most
    640 by 480 pixels.

    Args:
        topic: Name of the topic, such as `'/camera/image_raw'`. It need not exist yet.

    Returns:
        A picture in a cell, text for `print()`. `.close()` ends it.

    Raises:
        LabError: `topic` is not a valid topic name.
    """
    return ImageView(topic)


def _feed(topic: str, take: Any) -> Feed:
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from sensor_msgs.msg import Image

    # Best effort matches every camera, and only the newest image is of use.
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)  # type: ignore[no-untyped-call]
    return Feed(topic, helper(), take, msg_type=Image, qos_profile=qos, raw=True)


def _message(data: bytes) -> Image:
    from rclpy.serialization import deserialize_message
    from sensor_msgs.msg import Image

    found: Image = deserialize_message(data, Image)
    return found
