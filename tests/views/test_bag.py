"""The picture of a bag: what it says, what the page is told, and what it reads for that."""

from __future__ import annotations

import base64
import json
import struct
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import labkit as lab
from labkit.bags import reader
from labkit.bags.writer import BagWriter
from labkit.views import bag_reading
from labkit.views.message_tree import as_text, rows
from tests.views.bags import START_NS, make_camera, make_drive, make_empty, make_foreign

X = '/odom.pose.pose.position.x'
DRIVE = """\
drive: 133 messages of 4 topics. 10.0 s from 2023-11-14 22:13:20 UTC, {}.
  /cmd_vel  [geometry_msgs/msg/Twist]    11 messages   2 Hz   0.0 s to 5.0 s
  /never    [std_msgs/msg/String]        0 messages
  /odom     [nav_msgs/msg/Odometry]      101 messages  10 Hz  0.0 s to 10.0 s
  /scan     [sensor_msgs/msg/LaserScan]  21 messages   2 Hz   0.0 s to 10.0 s
/odom.pose.pose.position.x: 101 numbers, first 0 m, last 2 m, least 0 m, greatest 2 m
At the end: Robot at x = 2.00 m, y = 0.00 m, heading 57°."""
# Keeps what goes to the page, as a page would get it, and says what a page would say.
SPY = """
import json
import numpy as np
sent = []
view._widget.send = lambda content, buffers=None: sent.append((content, buffers))

def ask(**content):
    sent.clear()
    view._widget._handle_custom_msg(content, [])
    return sent[-1]
"""


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    return make_drive(tmp_path / 'drive')


def png_size(data: object) -> tuple[int, int]:
    return struct.unpack('>II', base64.b64decode(str(data))[16:24])  # type: ignore[return-value]


# --- Words and picture ---------------------------------------------------------------------------


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_words_tell_topics_counts_rates_and_times(tmp_path, storage):
    with lab.bag(make_drive(tmp_path / 'drive', storage=storage), X) as view:
        size = sum(path.stat().st_size for path in (tmp_path / 'drive').glob('drive_0.*'))
        about = f'{storage}, {size / 1000:.3g} kB'
        assert repr(view) == DRIVE.format(about)
        data = view._repr_mimebundle_()
        assert data['text/plain'] == repr(view) and set(data) == {'text/plain', 'image/png'}
        width, height = png_size(data['image/png'])
        assert 400 < width <= 800 and 400 < height <= 1000


@pytest.mark.slow('reads bags in kernels of their own')
def test_for_programs_nothing_depends_on_the_time(tmp_path, drive, start_kernel):
    kernel = start_kernel(LABKIT_HEADLESS='1')
    result = kernel.run(f'import labkit as lab\nlab.bag({str(drive)!r}, {X!r})')
    data = result.outputs[-1]['data']
    assert set(data) == {'text/plain', 'image/png'}
    assert data['text/plain'].splitlines()[:3] == [
        'drive: 133 messages of 4 topics, mcap',
        '  /cmd_vel  [geometry_msgs/msg/Twist]    11 messages',
        '  /never    [std_msgs/msg/String]        0 messages',
    ]
    assert ' Hz' not in data['text/plain'] and 'UTC' not in data['text/plain']


def test_a_bag_is_for_programs_too(drive):
    with lab.bag(drive) as view:
        assert [(topic.name, topic.count) for topic in view.topics if topic.count < 20] == [
            ('/cmd_vel', 11),
            ('/never', 0),
        ]
        found = [each.message.linear.x for each in view.messages('/cmd_vel', end_sec=1.0)]
        assert found == [0.2, 0.2, 0.2] and view.duration_sec == 10.0


def test_an_empty_bag_says_so(tmp_path):
    with lab.bag(make_empty(tmp_path / 'empty')) as view:
        assert 'empty: 0 messages of 1 topic. It is empty.' in repr(view)
        assert set(view._repr_mimebundle_()) == {'text/plain'}


def test_a_bag_with_one_message_has_a_picture(tmp_path):
    with lab.bag(make_foreign(tmp_path / 'arm', count=1), '/arm.angles[0]') as view:
        assert '  /arm  [my_robot_msgs/msg/Arm]  1 message  ' in repr(view)
        assert 'image/png' in view._repr_mimebundle_()


def test_an_unfinished_bag_says_so_and_is_shown(drive):
    (drive / 'metadata.yaml').unlink()
    with lab.bag(drive) as view:
        assert 'It is not complete (metadata.yaml is missing)' in view.note
        assert repr(view).splitlines()[-1] == view.note
        assert '/odom     [nav_msgs/msg/Odometry]      101 messages' in repr(view)


def test_a_type_that_is_not_installed_is_read_as_the_bag_defines_it(tmp_path):
    with lab.bag(make_foreign(tmp_path / 'arm'), '/arm.angles[0]', '/arm.first.position') as view:
        assert '/arm.angles[0]: 5 numbers, first 0, last 2, least 0, greatest 2' in repr(view)
        assert '/arm.first.position: 5 numbers, first 0, last 8' in repr(view)
        message = next(view.messages()).message
        assert bag_reading.number_paths(message) == [
            *('angles[0]', 'first.position', 'header.stamp.sec', 'header.stamp.nanosec'),
        ]
        assert "  name:'elbow'".replace(':', ': ') in as_text(rows(message))


def test_text_of_others_is_only_text(tmp_path):
    name = '/$x^{\x1b[31m<b>'
    path = make_foreign(tmp_path / '<img src=x>', topic=name)
    with lab.bag(path) as view:
        assert '\x1b' not in repr(view) and '/$x^{?[31m<b>' in repr(view)
        # Dollars would begin a formula, which can't be drawn.
        assert 'image/png' in view._repr_mimebundle_()


@pytest.mark.parametrize(
    ('field', 'words'),
    [
        ('/arm.angels[0]', "has no number 'angels[0]'.\nDid you mean '/arm.angles[0]'?"),
        ('/arm.state', "has no number 'state'.\nIts numbers: angles[0], first.position"),
        ('/arm.first', "has no number 'first'"),
        ('/leg.x', "has no topic '/leg'"),
        ('/arm', 'names a topic, but no field'),
    ],
)
def test_a_field_that_can_not_be_drawn_is_refused(tmp_path, field, words):
    path = make_foreign(tmp_path / 'arm')
    with pytest.raises(lab.LabError) as refused:
        lab.bag(path, field)
    assert words in str(refused.value)


def test_other_refusals(drive, tmp_path):
    for arguments, options, words in (
        ((drive, '/odom.pose.pose.position.X'), {}, "Did you mean '/odom.pose.pose.position.x'?"),
        ((drive,), {'odom': '/scan'}, 'must be of type nav_msgs/msg/Odometry'),
        ((drive, *(f'/scan.ranges[{n}]' for n in range(7))), {}, 'at most 6 fields, but got 7'),
        ((tmp_path / 'drives',), {}, 'There is no bag'),
    ):
        with pytest.raises(lab.LabError) as refused:
            lab.bag(*arguments, **options)
        assert words in str(refused.value)


def test_the_map_is_that_of_the_topic_that_is_asked_for(drive):
    with lab.bag(drive, odom='') as view:
        assert 'At the end' not in repr(view)
    with lab.bag(drive, odom='odom', scan='') as view:
        assert 'At the end' in repr(view) and view._scan == ''


# --- How it reads --------------------------------------------------------------------------------


def test_strip_has_columns_and_the_longest_pause(drive):
    with reader.open_bag(drive) as bag:
        strip = bag_reading.read_strip(bag, bag.topic('/cmd_vel'))
        assert strip.bins.sum() == 11 and np.flatnonzero(strip.bins)[-1] == bag_reading.BINS // 2
        assert strip.rate == 2.0 and strip.gap == (0.5, 0.0)
        assert bag_reading.read_strip(bag, bag.topic('/never')).rate is None
        # A bag may say that a topic has none of the messages that are there.
        assert replace(strip, topic=replace(strip.topic, count=0)).rate is None


def test_of_many_messages_some_are_read_and_none_are_kept(tmp_path, monkeypatch):
    writer = BagWriter(tmp_path / 'big')
    image = writer.add_topic('/image', 'std_msgs/msg/Int64', qos='', definition='', encoding='')
    size = 200_000
    for number in range(300):
        stamp = START_NS + number * 10**8
        data = b'\0\1\0\0' + struct.pack('<q', number) + bytes(size)
        writer.write([(image, stamp, stamp, data)])
    writer.close()
    monkeypatch.setattr(bag_reading, 'MAX_SAMPLES', 100)
    read = []
    at = reader.Bag.at
    monkeypatch.setattr(reader.Bag, 'at', lambda *args: read.append(args) or at(*args))
    tracemalloc.start()
    with lab.bag(tmp_path / 'big', '/image.data') as view:
        text = repr(view)
        peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert '/image.data: 100 numbers, first 0, last 297' in text
    assert text.endswith('Every 3rd message of /image is drawn.')
    assert len(read) == 100
    # Not a tenth of the bag at any time.
    assert peak < 300 * size / 10


def test_damage_is_told_and_the_rest_is_shown(tmp_path):
    path = make_foreign(tmp_path / 'arm', damaged=True)
    with lab.bag(path, '/arm.angles[0]') as view:
        assert '/arm  [my_robot_msgs/msg/Arm]  5 messages' in repr(view)
        assert 'no message of my_robot_msgs/msg/Arm' in repr(view)


# --- The page ------------------------------------------------------------------------------------


def test_page_is_told_what_there_is_and_asks_for_the_rest(kernel, drive):
    code = f'import labkit as lab\nview = lab.bag({str(drive)!r}, {X!r})\n{SPY}'
    assert not kernel.run(code).error
    stored, page = (output['data'] for output in kernel.run('view').outputs[-2:])
    assert list(page) == ['application/vnd.jupyter.widget-view+json']
    assert stored['text/plain'].startswith('drive: ')
    # No bag needs ROS to run.
    assert (
        kernel.run('from labkit.background.runtime import runtime\nprint(runtime.started)').text
        == 'False\n'
    )
    told = kernel.run(
        'state, (bins, track, line) = ask(see=True)\n'
        'table = np.frombuffer(track).reshape(-1, 6)\n'
        'print(json.dumps([state["name"], state["seconds"], state["track"], state["scan"],\n'
        '    state["series"], [row[0] for row in state["topics"]], state["topics"][0],\n'
        '    len(bins), table.shape, table[-1, :3].tolist(), np.frombuffer(line)[-1]]))'
    )
    name, seconds, odom, scan, series, names, row, size, shape, last, x = json.loads(told.text)
    assert (name, seconds, odom, scan, series) == ('drive', 10.0, '/odom', '/scan', [[X, 'm']])
    assert names == ['/cmd_vel', '/never', '/odom', '/scan']
    assert row[-1] == (
        '11 messages of /cmd_vel from 0.0 s to 5.0 s, longest pause 0.5 s, from 0.0 s on'
    )
    assert size == 4 * 4 * bag_reading.BINS and shape == [101, 6]
    assert last == pytest.approx([10.0, 2.0, 0.0]) and x == pytest.approx(2.0)
    told = kernel.run(
        'state, (ends,) = ask(at=5.04, topic="/cmd_vel")\n'
        'print(state["came"], state["fields"][1], np.frombuffer(ends, "<f4")[:2].round(3))\n'
        'print(ask(at=5.0, topic="")[0].keys())\n'
        'print(ask(paths="/scan")[0]["paths"][:2], ask(paths="/never")[0]["paths"])\n'
        'print(ask(lines=["/scan.ranges[0]", "/scan.ranges[0]"])[0])\n'
        'print(ask(lines=["/scan.angle"])[0]["refused"].splitlines()[0])\n'
        'print(ask(at=1.0, topic="/nothing")[0]["refused"].splitlines()[0])'
    ).text.splitlines()
    assert told == [
        # At 5 s the robot is at x = 1 m, its yaw is 0.5, and its scanner 3.2 cm behind that.
        "5.0 [1, 'x', 'double', False, '0.2'] [2.288 0.704]",
        "dict_keys(['at', 'of', 'buffers'])",
        "['angle_min', 'angle_max'] []",
        "{'series': [['/scan.ranges[0]', 'm']], 'refused': ''}",
        "'/scan.angle': sensor_msgs/msg/LaserScan has no field 'angle'.",
        "'drive' has no topic '/nothing'.",
    ]


def test_page_is_sent_the_picture_of_its_time(kernel, tmp_path):
    camera = make_camera(tmp_path / 'camera', 'rgb8', 'mono7', 'rgb8')
    code = f'import labkit as lab\nview = lab.bag({str(camera)!r})\n{SPY}'
    assert not kernel.run(code).error
    told = kernel.run(
        'for moment in (0.5, 1.5, 2.5):\n'
        '    state, buffers = ask(at=moment, topic="/camera")\n'
        '    starts = [data[:2].hex() for data in buffers or ()]\n'
        '    print(state["came"], state["picture"].splitlines()[0], state["buffers"], starts)'
    ).text.splitlines()
    # A JPEG begins with these two bytes.
    seen = "2 x 2 pixels, rgb8 ['picture'] ['ffd8']"
    unknown = "Pictures with the encoding 'mono7' can not be shown. [] []"
    assert told == [f'0.0 {seen}', f'1.0 {unknown}', f'2.0 {seen}']


def test_run_again_it_takes_the_place_of_the_one_before(kernel, drive):
    files = f"""
import glob, os
names = [os.readlink(link) for link in glob.glob('/proc/self/fd/*') if os.path.islink(link)]
print(sum({str(drive)!r} in name for name in names))
"""
    kernel.run('import labkit as lab')
    for _ in range(3):
        result = kernel.run(f'view = lab.bag({str(drive)!r})\n{SPY}\nview', cell_id='cell')
        assert not result.error
        assert kernel.run(files).text == '1\n'
    kernel.run('view.close()')
    assert kernel.run(files).text == '0\n'
    assert 'This bag has ended. Run its cell' in kernel.run('print(ask(see=True))').text
    # What was read can still be told.
    assert 'drive: 133 messages' in kernel.run('print(view)').text


def test_stopping_ros_does_not_end_it(kernel, drive):
    kernel.run(f'import labkit as lab\nlab.start()\nview = lab.bag({str(drive)!r})\n{SPY}\nview')
    kernel.run('lab.stop()')
    assert kernel.run('print(ask(see=True)[0]["name"])').text == 'drive\n'
