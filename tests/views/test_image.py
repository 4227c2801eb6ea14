"""Pictures of a camera: each encoding, what the page gets, and that the view lets go."""

from __future__ import annotations

import base64
import io
import tracemalloc

import numpy as np
import pytest
from PIL import Image as Pixels
from sensor_msgs.msg import Image

from labkit.errors import LabError
from labkit.views.image_pixels import picture_of, to_jpeg, to_png

STAGE = """
import labkit as lab
from labkit.background.runtime import runtime
from rclpy.node import Node
from sensor_msgs.msg import Image
camera = lab.spin(Node('camera'))
publisher = camera.create_publisher(Image, '/eye', 1)

def shoot(encoding='rgb8', size=(3, 2), data=bytes(range(18))):
    message = Image(encoding=encoding, width=size[0], height=size[1])
    message.step = len(data) // size[1]
    message.data = data
    publisher.publish(message)
"""
SPY = """
sent = []
page = view._widget
page.send = lambda content, buffers=None: sent.append((content, buffers))

def say(word):
    page._handle_custom_msg({'view': word}, [])
"""
COUNT = 'print(len(list(runtime.helper.subscriptions)), len(list(runtime.helper.timers)))'


def message(encoding: str, numbers: np.ndarray, *, spare: int = 0, big: bool = False) -> Image:
    """Return an image of these numbers, with spare bytes at the end of each row."""
    made = Image(encoding=encoding, height=numbers.shape[0], width=numbers.shape[1])
    made.is_bigendian = int(big)
    rows = [row.tobytes() + bytes(spare) for row in numbers]
    made.step = len(rows[0])
    made.data = b''.join(rows)
    return made


RGB = np.arange(2 * 4 * 3, dtype=np.uint8).reshape(2, 4, 3) * 10
ALPHA = np.dstack([RGB, np.full((2, 4), 7, np.uint8)])


@pytest.mark.parametrize(
    ('encoding', 'numbers', 'expected'),
    [
        ('rgb8', RGB, RGB),
        ('bgr8', RGB[..., ::-1], RGB),
        ('8UC3', RGB[..., ::-1], RGB),
        ('rgba8', ALPHA, RGB),
        ('bgra8', ALPHA[..., [2, 1, 0, 3]], RGB),
        ('rgb16', RGB.astype('<u2') * 256 + 99, RGB),
        ('mono8', RGB[..., 0], RGB[..., 0]),
        ('8UC1', RGB[..., 0], RGB[..., 0]),
        ('mono16', RGB[..., 0].astype('<u2') * 256, RGB[..., 0]),
    ],
)
def test_each_encoding_is_shown_as_it_is(encoding, numbers, expected):
    for spare in (0, 5):
        shown = picture_of(message(encoding, np.ascontiguousarray(numbers), spare=spare))
        assert (shown.pixels == expected).all() and shown.pixels.dtype == np.uint8
    assert shown.words == f'4 x 2 pixels, {encoding}'
    image = Pixels.open(io.BytesIO(to_png(shown)))
    assert (np.asarray(image) == expected).all()


@pytest.mark.parametrize('big', [False, True])
def test_depth_is_light_where_it_is_near(big):
    metres = np.array([[0.5, 2.0, np.nan], [1.0, np.inf, 0.0]])
    order = '>' if big else '<'
    for encoding, numbers in (
        ('32FC1', metres.astype(f'{order}f4')),
        ('16UC1', (np.nan_to_num(metres, posinf=0) * 1000).astype(f'{order}u2')),
    ):
        shown = picture_of(message(encoding, numbers, big=big))
        # What was not measured is black.
        assert shown.pixels.tolist() == [[255, 50, 0], [186, 0, 0]]
        assert shown.words.endswith('a depth from 0.50 m (light) to 2.00 m (dark)')
    nothing = picture_of(message('32FC1', np.full((2, 2), np.nan, np.float32)))
    assert 'nothing was measured' in nothing.words and not nothing.pixels.any()


def test_what_can_not_be_shown_says_why():
    with pytest.raises(LabError, match="encoding 'yuv422' can not be shown") as caught:
        picture_of(message('yuv422', RGB[..., :2]))
    assert 'rgb8, bgr8' in caught.value.todo
    short = message('rgb8', RGB)
    short.data = short.data[:-1]
    with pytest.raises(LabError, match='4 x 2 pixels of rgb8 in rows of 12 bytes, but it has 23'):
        picture_of(short)
    narrow = message('rgb8', RGB)
    narrow.step = 3
    for broken in (narrow, Image(encoding='rgb8'), Image(encoding='mono8', width=1)):
        with pytest.raises(LabError):
            picture_of(broken)


def test_a_single_row_takes_no_more_than_it_has():
    row = message('mono8', np.array([[1, 2]], np.uint8))
    row.step = 2**32 - 1
    tracemalloc.start()
    try:
        assert picture_of(row).pixels.tolist() == [[1, 2]]
        assert tracemalloc.get_traced_memory()[1] < 10**6
    finally:
        tracemalloc.stop()


def test_page_gets_no_more_than_it_can_show():
    large = picture_of(message('rgb8', np.zeros((1200, 1600, 3), np.uint8)))
    image = Pixels.open(io.BytesIO(to_jpeg(large)))
    assert image.size == (640, 480) and image.format == 'JPEG'
    small = Pixels.open(io.BytesIO(to_jpeg(picture_of(message('rgb8', RGB)))))
    assert small.size == (4, 2)


def test_page_gets_the_newest_picture_and_each_once(run):
    run(f"view = lab.image('/eye')\n{SPY}\ndisplay(view)\nsay('seen')")
    run('for number in range(50):\n    shoot(data=bytes([number] * 18))')
    run('lab.wait_until(lambda: view.count and any(b for _, b in sent))')
    run('shoot(data=bytes([200] * 18))\ncount = view.count')
    run('lab.wait_until(lambda: view.count > count and not view._is_new)')
    pictures = run('print(sum(bool(b) for _, b in sent), view.count)').split()
    assert 1 <= int(pictures[0]) <= int(pictures[1])
    said = run('print([c["text"] for c, _ in sent if "text" in c])')
    assert said == "['Picture of /eye: 3 x 2 pixels, rgb8.']"
    pixel = run(
        'import io, PIL.Image\n'
        'jpeg = [b for _, b in sent if b][-1][0]\n'
        'print(PIL.Image.open(io.BytesIO(jpeg)).getpixel((1, 1))[0])'
    )
    assert abs(int(pixel) - 200) < 5
    # A page that is loaded again gets it again.
    run("sent.clear()\nsay('seen')")
    assert run('print([bool(b) for _, b in sent][0])') == 'True'


@pytest.mark.slow('waits in real time')
def test_page_is_told_what_is_wrong(run):
    run(f"view = lab.image('/eye')\n{SPY}\ndisplay(view)\nsay('seen')\nshoot('yuv422')")
    run(
        """lab.wait_until(lambda: any("'yuv422' can not" in c.get('note', '') for c, _ in sent))"""
    )
    assert "/eye: Pictures with the encoding 'yuv422'" in run('print(view.text)')
    # Then it is well again, and the note goes.
    run('sent.clear()\nshoot()')
    run("lab.wait_until(lambda: any(c.get('note') == '' for c, _ in sent))")
    run(f"view = lab.image('/nowhere')\n{SPY}\ndisplay(view)\nsay('seen')")
    run("lab.wait_until(lambda: 'Nobody publishes on /nowhere' in str(sent))")


def test_closing_leaves_nothing(run):
    before = run(COUNT)
    run(f"view = lab.image('/eye')\n{SPY}\ndisplay(view)\nsay('seen')")
    assert run(COUNT) != before
    run("say('gone')")
    assert run(COUNT) == before
    run("say('seen')\nview.close()\nsay('seen')")
    assert run(COUNT) == before


def test_headless_it_is_a_picture_and_words(run_still):
    run_still('robot = lab.spin(lab.Turtlebot(x=0.5))')
    result = run_still("lab.image('/camera/image_raw')")
    data = result.outputs[-1]['data']
    assert set(data) == {'text/plain', 'image/png'}
    assert data['text/plain'] == 'Picture of /camera/image_raw: 320 x 240 pixels, rgb8.'
    image = Pixels.open(io.BytesIO(base64.b64decode(data['image/png'])))
    assert image.size == (320, 240)
    assert 'Nobody publishes on /nowhere' in run_still("print(lab.image('/nowhere'))").text
