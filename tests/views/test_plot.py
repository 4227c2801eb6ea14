"""The plot: which fields it takes, what it sends to the page, and its still form."""

from __future__ import annotations

import math
import sys
from xml.etree import ElementTree

import numpy as np
import pytest

from labkit.errors import LabError
from labkit.views.plot_fields import number_paths, parse, resolve, unit_of
from labkit.views.plot_picture import COLOURS, DASHES, Line, in_words, limits, thin, ticks, to_svg
from tests.views.test_monitor import STAGE as COMMON_STAGE

STAGE = f"""{COMMON_STAGE}
import numpy as np

class PlotPage(Page):
    # Puts together what was sent, as a page would.
    def __init__(self, view):
        self.times_of, self.values_of = {{}}, {{}}
        super().__init__(view)

    def take(self, content, buffers=None):
        if content.get('anew'):
            self.times_of, self.values_of = {{}}, {{}}
        for number, data in zip(content.get('parts', ()), buffers or ()):
            numbers = np.frombuffer(data, '<f8')
            half = len(numbers) // 2
            self.times_of.setdefault(number, []).extend(numbers[:half])
            self.values_of.setdefault(number, []).extend(numbers[half:])
        super().take(content, buffers)

    def numbers(self, part=0):
        return [v for v in self.values_of.get(part, ()) if v == v]

    def wait_numbers(self, count, part=0):
        lab.wait_until(lambda: len(self.numbers(part)) >= count, timeout_sec=20)
"""


def test_sends_every_value_in_order(run):
    run('talker = lab.spin(Talker())\npage = PlotPage(lab.plot("odds.data"))')
    run('page.wait_numbers(100)')
    assert run('print(page.known["series"], page.known["seconds"])') == "[['odds.data', '']] 10.0"
    values = eval(run('print(list(map(int, page.numbers())))'))  # what this test has sent itself
    assert values == list(range(values[0], values[0] + len(values)))
    assert run('print(page.times_of[0] == sorted(page.times_of[0]))') == 'True'
    # One that opens later gets the same.
    count = len(values)
    run('page.say("seen")\npage.wait(lambda known: not known["note"])')
    assert int(run('print(len(page.numbers()))')) >= count


def test_several_fields_and_topics_with_units(run):
    run('robot = lab.spin(lab.Turtlebot())')
    fields = '"/odom.pose.pose.position.x", "/scan.ranges[0]", "odom.twist.twist.angular.z"'
    run(f'page = PlotPage(lab.plot({fields}))')
    run('for part in range(3): page.wait_numbers(3, part)')
    assert [unit for _, unit in eval(run('print(page.known["series"])'))] == ['m', 'm', 'rad/s']
    assert run('print(ears("/odom"), ears("/scan"))') == '1 1'


def test_waits_for_topics_and_says_what_is_wrong(run):
    run('page = PlotPage(lab.plot("/odds.daat", "/other.data"))')
    note = run('print(page.known["note"])')
    assert 'Nobody publishes on /odds.' in note and 'Nobody publishes on /other.' in note
    run('talker = lab.spin(Talker())')
    run('page.wait(lambda known: "Did you mean \'/odds.data\'?" in known["note"])')
    run('page = PlotPage(lab.plot("/odds.data"))\npage.wait_numbers(3)')
    # The talker comes back with another type, which has no numbers, and then with numbers again.
    run('talker = lab.spin(Talker(String))')
    run('page.wait(lambda known: "is a text" in known["note"])')
    run('talker = lab.spin(Talker())\npage.wait(lambda known: not known["note"])')


def test_array_that_is_too_short(run):
    run('robot = lab.spin(lab.Turtlebot())\npage = PlotPage(lab.plot("/scan.ranges[400]"))')
    run('page.wait(lambda known: "the array is shorter" in known["note"])')


def test_leaves_nothing_behind(run):
    run('talker = lab.spin(Talker())\nview = lab.plot("/odds.data", "/odds.data")')
    timers = run('print(len(list(runtime.helper.timers)))')
    assert run('print(ears())') == '0'
    for leave in ('page.say("gone")', 'view.close()'):
        assert run('page = PlotPage(view)\nprint(ears())') == '1'
        run(f'page.wait_numbers(3)\n{leave}')
        assert run('print(ears(), len(list(runtime.helper.timers)))') == f'0 {timers}'
    assert run('page.say("seen")\nprint(ears(), page.known["ended"])') == (
        '0 This plot has ended. Run its cell to start a new one.'
    )


def test_last_lines_stay_when_ros_is_stopped_before_the_page_asks(run):
    # As in Run All: the kernel hears the page only when a later cell has stopped ROS.
    run('talker = lab.spin(Talker())\nview = lab.plot("/odds.data")\ndisplay(view)')
    run('seen = talker.count\nlab.wait_until(lambda: talker.count >= seen + 20)\nlab.stop()')
    run('page = PlotPage(view)')
    assert run('print(len(page.numbers()) >= 20, page.known["ended"])') == (
        'True ROS was stopped. Run this cell to start it again.'
    )
    assert run('print("image/svg+xml" in view._stored_form())') == 'True'


def test_time_in_which_nobody_looked_is_a_gap(run):
    run('talker = lab.spin(Talker())\npage = PlotPage(lab.plot("/odds.data"))')
    run('page.wait_numbers(5)\npage.say("gone")\npage.say("there")')
    run('page.wait_numbers(len(page.numbers()) + 5)')
    values = eval(run('print([v if v == v else None for v in page.values_of[0]])'))
    # It begins with one, too: before that nobody looked.
    assert None in values[1:-1]


@pytest.mark.slow('a thousand messages a second')
def test_thousand_messages_a_second_are_few_updates(run):
    run('talker = lab.spin(Talker(period=0.001))\npage = PlotPage(lab.plot("/odds.data"))')
    run('lab.wait_until(lambda: talker.count > 3000, timeout_sec=60)')
    run('times = list(page.times)')
    assert int(run('print(max(sum(t <= u < t + 1 for u in times) for t in times))')) <= 20
    # Thinned, with nothing cut off: the highest and the lowest value are there.
    run('lab.wait_until(lambda: max(page.numbers()) == 999 and min(page.numbers()) == 0)')
    sent = int(run('print(len(page.numbers()))'))
    assert sent <= 2 * 80 * float(run('print(page.known["now"])')) + 3 * int(
        run('print(len(page.sent))')
    )


def test_ticks_that_come_close_together_are_one_update(run):
    run('talker = lab.spin(Talker(period=0.001))\npage = PlotPage(plot := lab.plot("/odds.data"))')
    run('page.wait_numbers(10)\nbefore = len(page.times)')
    # As when a late timer catches up: all of these fall into far less time than one update has.
    run('with plot._lock:\n    for _ in range(30): plot._tick()')
    run('lab.wait_until(lambda: len(page.times) > before + 3)')
    assert run('print(min(b - a for a, b in zip(page.times, page.times[1:])) >= 0.05)') == 'True'


@pytest.mark.slow('a thousand messages a second')
def test_all_of_a_thousand_messages_a_second_are_taken(run):
    run('talker = lab.spin(Talker(period=0.001))\nplot = PlotPage(lab.plot("/odds.data"))')
    run('monitor = Page(lab.monitor("/odds"))\nstart = talker.count')
    run('lab.wait_until(lambda: talker.count > start + 2000, timeout_sec=60)')
    run('for timer in list(talker.timers): timer.cancel()')
    run('monitor.wait(lambda known: known["values"] == [str(talker.count % 1000)])')
    assert run('print(monitor.known["count"] >= talker.count - start)') == 'True'
    run('lab.wait_until(lambda: plot.numbers()[-1] == talker.count % 1000)')


@pytest.mark.slow('waits in real time')
def test_still_form_is_the_same_each_time(run_still):
    text = run_still('print(lab.plot("/odds.data"))').text
    assert text.startswith('Nobody publishes on /odds.')
    run_still('before = ears()\ntalker = lab.spin(Talker(waits=True))')
    run_still('def show():\n    talker.count = 0\n    return lab.plot("/odds.data", count=20)')
    data = run_still('show()').outputs[-1]['data']
    assert data['text/plain'] == (
        '/odds.data: 20 messages, first 1, last 20, least 1, greatest 20'
    )
    picture = ElementTree.fromstring(data['image/svg+xml'])
    assert data['text/plain'] in ''.join(picture.itertext())
    assert run_still('show()').outputs[-1]['data'] == data
    assert run_still('print(ears() - before)').text == '0\n'


def test_still_form_has_units(run_still):
    run_still('robot = lab.spin(lab.Turtlebot())')
    text = run_still('print(lab.plot("/odom.twist.twist.linear.x", "/scan.ranges[0]", count=2))')
    assert text.text == (
        '/odom.twist.twist.linear.x: 2 messages, first 0 m/s, last 0 m/s, least 0 m/s, '
        'greatest 0 m/s\n'
        '/scan.ranges[0]: 2 messages, first 2.532 m, last 2.532 m, least 2.532 m, greatest '
        '2.532 m\n'
    )


def test_wrong_words_are_answered(kernel, run):
    run('robot = lab.spin(lab.Turtlebot())')
    for code, words in (
        ('lab.plot()', 'takes 1 to 6 fields'),
        ('lab.plot("/odom.pose.pose.position.X")', "Did you mean '/odom.pose.pose.position.x'?"),
        ('lab.plot("/odom.header.frame_id")', 'is a text. Only numbers can be drawn'),
        ('lab.plot("/odom.pose.pose.position.x", seconds=0)', 'seconds must be a number'),
        ('lab.plot("/odom.pose.pose.position.x", seconds=5e-324)', 'from 0.1 to 3600'),
        ('lab.plot("/odom.pose.pose.position.x", seconds=10**400)', 'from 0.1 to 3600'),
        (f'lab.plot("/scan.ranges[{"9" * 5000}]")', 'names no field of a message'),
        ('lab.plot("/odom.pose.pose.position.x", count=0)', 'count must be a whole number'),
    ):
        result = kernel.run(code)
        assert result.error.startswith('LabError') and words in result.error
    assert run('print(ears("/odom"))') == '0'


@pytest.mark.parametrize(
    'text', ['', '/odom', '.x', '/odom.', '/odom.x y', '/odom.x[', '/a..b', 3]
)
def test_text_that_is_no_field(text):
    with pytest.raises(LabError, match=r'names (no field|a topic)|must be a text'):
        parse(text)


def _types():
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import Imu, JointState, LaserScan, Range, Temperature
    from std_msgs.msg import Bool, Header, Int16, String
    from trajectory_msgs.msg import JointTrajectory

    return {
        each.__name__: each
        for each in (
            Odometry,
            Imu,
            JointState,
            LaserScan,
            Range,
            Temperature,
            Bool,
            Header,
            Int16,
            String,
            JointTrajectory,
        )
    }


@pytest.mark.parametrize(
    ('name', 'path', 'unit'),
    [
        ('Odometry', 'pose.pose.position.x', 'm'),
        ('Odometry', 'pose.pose.orientation.w', ''),
        ('Odometry', 'twist.twist.linear.x', 'm/s'),
        ('Odometry', 'twist.twist.angular.z', 'rad/s'),
        ('Odometry', 'pose.covariance[35]', ''),
        ('Odometry', 'header.stamp.sec', 's'),
        ('Imu', 'linear_acceleration.x', 'm/s²'),
        ('LaserScan', 'ranges[0]', 'm'),
        ('LaserScan', 'angle_increment', 'rad'),
        ('Range', 'range', 'm'),
        ('Range', 'variance', 'm²'),
        ('Temperature', 'temperature', '°C'),
        ('Bool', 'data', ''),
        ('Int16', 'data', ''),
        ('JointTrajectory', 'points[0].positions[1]', 'rad or m'),
    ],
)
def test_units_of_usual_messages(name, path, unit):
    msg_type = _types()[name]
    assert resolve(parse(f'/t.{path}'), msg_type) is not None
    assert unit_of(path, msg_type) == unit


def test_numbers_of_messages():
    types = _types()
    assert resolve(parse('t.data'), types['Bool'])(types['Bool'](data=True)) is True
    scan = types['LaserScan'](ranges=[1.5, 2.5])
    assert resolve(parse('t.ranges[1]'), types['LaserScan'])(scan) == 2.5
    with pytest.raises(IndexError):
        resolve(parse('t.ranges[2]'), types['LaserScan'])(scan)
    for msg_type in types.values():
        for path in number_paths(msg_type):
            resolve(parse(f't.{path}'), msg_type)
    assert list(number_paths(types['String'])) == []


@pytest.mark.parametrize(
    ('name', 'path', 'words'),
    [
        ('Odometry', 'position.x', "Did you mean 't.pose.pose.position.x'?"),
        ('Odometry', 'pose', "is a geometry_msgs/msg/PoseWithCovariance. Only numbers can"),
        ('Odometry', 'twist.twist.lin', "Did you mean 't.twist.twist.linear.x'?"),
        ('Odometry', 'pose.covariance[36]', 'the last one is [35]'),
        ('Odometry', 'pose.covariance', "Did you mean 't.pose.covariance[0]'?"),
        ('Odometry', 'child_frame_id[0]', 'is no array'),
        ('LaserScan', 'range[0]', "Did you mean 't.ranges[0]'?"),
        ('LaserScan', 'ranges[0].x', 'has no field'),
        ('JointState', 'name[0]', 'is a text'),
        ('String', 'data', 'has no field that is a number'),
        ('Odometry', 'zzz', 'Its numbers: pose.pose.position.x, '),
    ],
)  # fmt: skip
def test_fields_that_can_not_be_drawn(name, path, words):
    with pytest.raises(LabError) as caught:
        resolve(parse(f't.{path}'), _types()[name])
    assert words in str(caught.value)


def test_thinning_keeps_what_can_be_seen():
    times = np.arange(1000) / 1000
    values = np.sin(times * 40)
    values[500] = 9.0
    few_times, few = thin(times, values, 0.05)
    assert len(few) == len(few_times) == 41 and (np.diff(few_times) >= 0).all()
    assert few.max() == 9.0 and few.min() == values.min() and few[-1] == values[-1]
    # Few samples stay as they are; what is no number is left out, or a gap.
    assert thin(times, values, 0.0005)[1] is values
    values[100:200] = np.nan
    few = thin(times, values, 0.05)[1]
    assert np.isnan(few[4:8]).all() and np.isfinite(np.delete(few, np.s_[4:8])).all()
    # One between many others, too.
    values[725] = np.nan
    few_times, few = thin(times, values, 0.05)
    assert (np.diff(few_times) >= 0).all() and np.flatnonzero(np.isnan(few)).tolist()[4:] == [29]


def test_axes_have_round_numbers():
    assert ticks(0, 10) == [0, 2, 4, 6, 8, 10]
    assert ticks(-0.03, 0.021) == pytest.approx([-0.02, 0.0, 0.02])
    for low, high in ((1e-9, 2e-9), (-1e6, 3.0), (5.0, 5.0001)):
        assert 2 <= len(ticks(low, high)) <= 6
    assert limits([2.0, 2.0]) == (1.0, 3.0) and limits([]) == (-0.5, 0.5)
    low, high = limits([math.nan, 1.0, math.inf, 3.0])
    assert low < 1.0 and 3.0 < high < 4.0


def test_picture_escapes_and_tells_lines_apart():
    lines = [Line(f'<b>{n}', '"m"' if n % 2 else 's', [1.0, math.nan, n]) for n in range(6)]
    root = ElementTree.fromstring(to_svg(lines, '<script>'))
    tags = {element.tag.rpartition('}')[2] for element in root.iter()}
    assert tags == {'svg', 'title', 'rect', 'path', 'text'}
    strokes = {(path.get('stroke'), path.get('stroke-dasharray')) for path in root.iter()}
    assert len([stroke for stroke in strokes if stroke[0] in COLOURS]) == 6
    assert len(set(DASHES)) == len(DASHES) == len(COLOURS)


@pytest.mark.parametrize(
    'values',
    [
        [1e308, -1e308],
        [5e-324],
        [0.0, 5e-324],
        [-5e-324, 5e-324],
        [sys.float_info.max, -sys.float_info.max, 0.0],
        [sys.float_info.max],
        [1.0, 1.0 + sys.float_info.epsilon],
    ],
)
def test_greatest_and_least_numbers_have_a_picture(values):
    root = ElementTree.fromstring(to_svg([Line('a', '', values)], ''))
    lines = [each.get('d', '') for each in root.iter() if each.get('stroke') == COLOURS[0]]
    heights = [float(place.split()[1].split('h')[0]) for place in lines[-1][1:].split('L')]
    assert len(heights) == len(values) and all(0 <= height <= 300 for height in heights)
    assert 2 <= len(ticks(*limits(values))) <= 12


def test_words_have_the_greatest_and_the_least_numbers():
    most = sys.float_info.max
    assert in_words([1.0, most], 'm') == 'first 1 m, last 1.798e+308 m, least 1 m, ' + (
        'greatest 1.798e+308 m'
    )
    assert in_words([-0.0, 12345.0, 5e-324, math.inf, math.nan], '') == (
        'first 0, last nan, least 0, greatest 12340'
    )
