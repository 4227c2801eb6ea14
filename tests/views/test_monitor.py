"""The monitor: what it hears and tells the page, why nothing comes, and that it lets go."""

from __future__ import annotations

import pytest

from labkit.background.domains import claim_domain

STAGE = """
import time
import labkit as lab
from labkit.background.runtime import runtime
from labkit.views import live_page
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int16, String

class Talker(Node):
    def __init__(self, msg_type=Int16, name='talker', qos=10, period=0.01, waits=False):
        super().__init__(name)
        self.count = 0
        self.waits = waits
        self.msg_type = msg_type
        self.publisher = self.create_publisher(msg_type, 'odds', qos)
        if period:
            self.create_timer(period, self.tick)

    def tick(self):
        # One that waits counts only for those that listen, so what they hear is known.
        if not self.waits or self.publisher.get_subscription_count():
            self.say()

    def say(self, data=None):
        self.count += 1
        data = data if data is not None else self.count % 1000
        self.publisher.publish(self.msg_type(data=data if self.msg_type is Int16 else str(data)))

def ears(topic='/odds'):
    return len([s for s in runtime.helper.subscriptions if s.topic_name == topic])

class Page:
    # What a page would get, and what it would say.
    def __init__(self, view):
        self.widget, self.sent, self.times, self.known = view._widget, [], [], {}
        self.widget.send = self.take
        self.say('seen')

    def take(self, content, buffers=None):
        self.sent.append(content)
        self.times.append(time.monotonic())
        self.known.update(content)

    def say(self, word):
        self.widget._handle_custom_msg({'view': word}, [])

    def wait(self, condition):
        lab.wait_until(lambda: condition(self.known), timeout_sec=20)
"""


def test_tells_message_count_rate_and_publishers(run):
    run('talker = lab.spin(Talker())\npage = Page(lab.monitor("odds"))')
    run('page.wait(lambda known: known.get("count", 0) > 100 and known.get("rate"))')
    assert run('print(page.known["topic"], page.known["type"])') == '/odds std_msgs/msg/Int16'
    assert run('print(page.known["publishers"])') == "[['/talker', 'reliable', 'volatile']]"
    assert run('print(page.known["fields"])') == "[(0, 'data', 'int16', False)]"
    # A busy machine may be late, so only the order of magnitude of 100 Hz.
    assert 5 < float(run('print(page.known["rate"])')) < 1000
    # What is shown in the end is the last message, and it came just now.
    # In one cell: soon after it, the page is told that nothing comes.
    last = run(
        '[timer.cancel() for timer in talker.timers]\n'
        'page.wait(lambda known: int(known["values"][0]) == talker.count % 1000)\n'
        'print(page.known["note"], page.known["age"] < 5)'
    )
    assert last == 'True'


def test_tells_the_course_of_the_rate(run):
    # Ten samples, a tenth of a second apart, so that it need not take a minute.
    run('from labkit.views import monitor\nmonitor.SAMPLES, monitor.SAMPLE_SEC = 10, 0.1')
    run('talker = lab.spin(Talker())\npage = Page(lab.monitor("/odds"))')
    run('page.wait(lambda known: len(known["course"][0]) > 5)')
    run('[timer.cancel() for timer in talker.timers]')
    # It falls to nothing when the topic does, and ends after so many samples.
    run('page.wait(lambda known: known["course"][0][-1] == 0)')
    assert run('print(page.known["course"][1])').startswith('0 to ')
    run('page.wait(lambda known: not any(known["course"][0]))')
    assert run('print(len(page.known["course"][0]), page.known["course"][1])') == '10 0'
    # What was when nobody looked is not known.
    assert run('page.say("gone")\npage.say("seen")\nprint(page.known["course"][0])') == '[]'


def test_waits_for_a_topic_and_says_what_is_wrong(run):
    run('page = Page(lab.monitor("/odds"))')
    assert 'Nobody publishes on /odds.' in run('print(page.known["note"], ears())')
    run('lab.spin(Node("other")).create_publisher(Int16, "/Odds", 10)')
    run('page.wait(lambda known: "but somebody does on /Odds" in known["note"])')
    run('lab.remove("other")\ntalker = lab.spin(Talker())')
    run('page.wait(lambda known: known.get("values") and not known["note"])')
    assert run('print(ears())') == '1'
    # Its publisher goes: that is said, and another type may come in the same process.
    run('lab.remove(talker)')
    assert run('print(ears())') == '0'
    run('page.wait(lambda known: "Nobody publishes on /odds" in known["note"])')
    run('talker = lab.spin(Talker(String))')
    run('page.wait(lambda known: known["type"] == "std_msgs/msg/String" and not known["note"])')


def test_cell_with_the_talker_may_change_the_type(run):
    run('talker = lab.spin(Talker())\npage = Page(lab.monitor("/odds"))')
    run('page.wait(lambda known: known.get("values"))')
    run('talker = lab.spin(Talker(String))')
    run('page.wait(lambda known: known["type"] == "std_msgs/msg/String")')
    run('page.wait(lambda known: known["values"][0].startswith("\'"))')


def test_other_type_than_asked_for(run):
    run('talker = lab.spin(Talker())')
    run('page = Page(lab.monitor("/odds", msg_type="std_msgs/msg/String"))')
    note = run('print(page.known["note"])')
    assert '/talker publishes on /odds, but messages of another type: std_msgs/msg/Int16' in note
    assert run('print(ears())') == '0'
    run('page = Page(lab.monitor("/odds", msg_type=Int16))')
    run('page.wait(lambda known: known.get("values"))')


@pytest.mark.slow('waits in real time')
@pytest.mark.parametrize(
    ('qos', 'words'),
    [
        ('reliability=ReliabilityPolicy.BEST_EFFORT', ['best effort', 'volatile']),
        ('durability=DurabilityPolicy.TRANSIENT_LOCAL', ['reliable', 'transient local']),
    ],
)
def test_hears_publishers_of_any_qos(run, qos, words):
    run(f'talker = lab.spin(Talker(qos=QoSProfile(depth=1, {qos}), period=None))')
    # Said before anybody listened: kept by a publisher that is transient local.
    run('talker.say(7)\npage = Page(lab.monitor("/odds"))')
    if 'volatile' in words:
        run('talker.say(7)')
    run('page.wait(lambda known: known.get("values") == ["7"])')
    assert run('print(page.known["publishers"])') == f'[{["/talker", *words]}]'
    # With a second one that offers something else, it asks for what both can give.
    run('second = lab.spin(Talker(name="second", period=0.05))')
    run('page.wait(lambda known: known["count"] > 5)\ntalker.say(-8)')
    run('page.wait(lambda known: len(known["publishers"]) == 2)\nprint(ears())')
    run('lab.remove("second")\ntalker.say(-9)\npage.wait(lambda known: known["values"] == ["-9"])')


def test_qos_that_does_not_match_is_told(run):
    run(
        'qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)\n'
        'talker = lab.spin(Talker(qos=qos))\npage = Page(lab.monitor("/odds", qos_profile=10))\n'
        'page.wait(lambda known: "QoS profile does not match" in known["note"])'
    )
    assert run('print(page.known["count"])') == '0'


def test_ends_that_do_not_match_are_told_though_the_view_hears(run):
    run(
        'qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)\n'
        'talker = lab.spin(Talker(qos=qos))\nlistener = lab.spin(Node("listener"))\n'
        'listener.create_subscription(Int16, "odds", print, 10)\n'
        'page = Page(lab.monitor("/odds"))\n'
        'page.wait(lambda known: known.get("count") and "/listener" in known["note"])'
    )
    run('listener.destroy_node()\npage.wait(lambda known: not known["note"])')


@pytest.mark.slow('waits in real time')
def test_publisher_that_says_nothing(run):
    run('talker = lab.spin(Talker(period=None))\npage = Page(lab.monitor("/odds"))')
    run('page.wait(lambda known: "nothing came from it" in known["note"])')
    run('talker.say()\npage.wait(lambda known: known["count"] == 1)')


def test_leaves_nothing_behind(run):
    run('talker = lab.spin(Talker())\nview = lab.monitor("/odds")')
    timers = run('print(len(list(runtime.helper.timers)))')
    assert run('print(ears())') == '0'  # nobody has looked yet
    run('page = Page(view)')
    assert run('print(ears())') == '1'
    for leave in ('page.say("gone")', 'view.close()'):
        run(leave)
        assert run('print(ears(), len(list(runtime.helper.timers)))') == f'0 {timers}'
        run('page.say("seen")')
        assert run('print(ears())') == ('0' if 'close' in leave else '1')
    assert 'This monitor has ended' in run('print(page.known["ended"])')
    run('with lab.monitor("/odds") as view:\n    page = Page(view)')
    assert run('print(ears())') == '0'


def test_cell_that_is_run_again_has_one_subscription(kernel, run):
    run('talker = lab.spin(Talker())\npages = []')
    code = 'pages.append(Page(lab.monitor("/odds")))\nprint(ears())'

    def run_cell(cell_id):
        content = {'code': code, 'silent': False, 'store_history': True, 'allow_stdin': False}
        message = kernel._client.session.msg('execute_request', content)
        message['metadata']['cellId'] = cell_id
        kernel._client.shell_channel.send(message)
        return kernel.finish(message['header']['msg_id']).text.strip()

    assert [run_cell('one') for _ in range(5)] == ['1'] * 5
    assert run_cell('two') == '2'
    assert run('print([("ended" in page.known) for page in pages])') == (
        '[True, True, True, True, False, False]'
    )


def test_end_of_ros_ends_it(run):
    run('talker = lab.spin(Talker())\npage = Page(lab.monitor("/odds"))')
    run('page.wait(lambda known: known.get("values"))\nlab.stop()\nlab.start()\npage.say("there")')
    assert 'ROS was stopped' in run('print(page.known["ended"], ears())')
    assert run('page.say("seen")\nprint(ears())') == '0'
    # A page that comes too late does not start ROS again.
    run('view = lab.monitor("/odds")\nlab.stop()\npage = Page(view)')
    assert run('print(runtime.started, "stopped" in page.known["ended"])') == 'False True'


@pytest.mark.slow('waits in real time')
def test_page_that_is_gone_without_a_word_is_missed(run):
    run('talker = lab.spin(Talker())\npage = Page(lab.monitor("/odds"))')
    # In a cell that runs, a page can not be heard, so it is not given up. With these limits, it
    # may be so between any two cells.
    code = 'live_page.GONE_SEC = live_page.CATCH_UP_SEC = 0.2\npage.say("there")'
    wait = 'said = talker.count\nlab.wait_until(lambda: talker.count > said + 200)'
    assert run(f'{code}\n{wait}\nprint(ears())') == '1'
    run('import asyncio\nwhile ears():\n    await asyncio.sleep(0.02)')
    assert run('print(ears())') == '0'
    # It may have slept.
    assert run('page.say("there")\nprint(ears())') == '1'


@pytest.mark.slow('a thousand messages a second')
def test_thousand_messages_a_second_are_few_updates(run):
    run('talker = lab.spin(Talker(period=0.001))\npage = Page(lab.monitor("/odds"))')
    run('lab.wait_until(lambda: talker.count > 3000, timeout_sec=60)')
    run('times = list(page.times)')
    most = run('print(max(sum(t <= u < t + 1 for u in times) for t in times))')
    assert int(most) <= 20
    # All are counted, the last one is shown.
    run('page.wait(lambda known: known["count"] > 3000)')
    # How many a busy machine publishes in a second is not known, but updates are far fewer.
    assert run('print(page.known["count"] > 3 * len(page.sent))') == 'True'


def test_still_text_is_the_same_each_time(run_still):
    assert run_still('print(lab.monitor("/odds"))').text == (
        '/odds: no message came. Nobody publishes on /odds. Is the node that should publish '
        'there running (lab.spin), and in the same domain?\n'
    )
    run_still('before = ears()\ntalker = lab.spin(Talker(String, waits=True))')
    result = run_still('talker.count = 0\nlab.monitor("/odds", count=3)')
    assert result.outputs[-1]['data'] == {
        'text/plain': '/odds [std_msgs/msg/String]\npublished by /talker (reliable, volatile)\n'
        "message 3 of 3:\ndata: '3'"
    }
    assert run_still('print(ears() - before)').text == '0\n'


def test_still_text_of_a_robot_has_no_time(run_still):
    run_still('robot = lab.spin(lab.Turtlebot())')
    first = run_still('print(lab.monitor("/odom"))').text
    assert '  stamp: <builtin_interfaces/Time>\n' in first
    assert 'covariance: [0.05, 0.0, 0.0, 0.0, 0.0, ...] 36 values\n' in first
    assert run_still('print(lab.monitor("/odom"))').text == first
    assert 'ranges: [2.532, ' in run_still('print(lab.monitor("/scan"))').text


@pytest.mark.slow('waits in real time')
def test_still_text_says_why_nothing_comes(run_still):
    run_still('talker = lab.spin(Talker())')
    text = run_still('print(lab.monitor("/odds", msg_type=String))').text
    assert 'messages of another type: std_msgs/msg/Int16, not std_msgs/msg/String' in text


def test_wrong_words_are_answered(run):
    for code, words in (
        (
            'lab.monitor("/odds", msg_type="std_msgs/msg/int16")',
            "Did you mean 'std_msgs/msg/Int16'?",
        ),
        ('lab.monitor("/odds", msg_type=3)', 'msg_type must be a message class'),
        ('lab.monitor("not a topic")', 'is no name of a topic'),
        ('lab.monitor("/odds", count=0)', 'count must be a whole number'),
    ):
        caught = run(f'try:\n    {code}\nexcept lab.LabError as error:\n    print(error)')
        assert words in caught


@pytest.mark.slow('waits in real time')
def test_hears_other_processes(start_kernel):
    claim = claim_domain()
    env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(claim.domain_id)}
    here, there = start_kernel(**env), start_kernel(**env)
    for kernel in (here, there):
        assert not kernel.run(STAGE).error
    assert not here.run('page = Page(lab.monitor("/odds"))').error
    best_effort = 'QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)'
    assert not there.run(f'talker = lab.spin(Talker(qos={best_effort}))').error
    wait = 'page.wait(lambda known: {})\nprint(page.known["type"], page.known["publishers"])'
    # The name of its node comes a moment later.
    named = 'known["publishers"][0][0] == "/talker"'
    first = here.run(wait.format(f'known.get("values") and {named}'))
    assert first.text == "std_msgs/msg/Int16 [['/talker', 'best effort', 'volatile']]\n"
    # Now the same node publishes another type.
    assert not there.run('talker = lab.spin(Talker(String))').error
    second = here.run(wait.format(f'known["type"].endswith("String") and {named}'))
    assert second.text == "std_msgs/msg/String [['/talker', 'reliable', 'volatile']]\n"
    text = here.run('print(lab.monitor("/odds"))').text
    assert text.startswith(
        '/odds [std_msgs/msg/String]\npublished by /talker (reliable, volatile)'
    )
    claim.close()


def test_rows_of_messages():
    from geometry_msgs.msg import Pose, PoseArray
    from sensor_msgs.msg import LaserScan
    from std_msgs.msg import Bool, Int32MultiArray, String

    from labkit.views.message_tree import as_text, rows

    assert as_text(rows(Bool(data=True))) == 'data: true'
    assert as_text(rows(String(data='a\nb' + 'x' * 500))) == f"data: 'a\\nb{'x' * 117}...'"
    scan = LaserScan(ranges=[float('inf'), 1.0] * 10, scan_time=0.2)
    text = as_text(rows(scan, no_time=True))
    assert 'ranges: [inf, 1.0, inf, 1.0, inf, ...] 20 values' in text
    assert 'intensities: []' in text and 'scan_time: 0.2\n' in text
    assert 'stamp:\n    sec: 0' in as_text(rows(scan))
    found = rows(PoseArray(poses=[Pose() for _ in range(200)]))
    assert found[5].value == '200 elements, the first 3' and len(found) == 6 + 3 * 10
    assert as_text(rows(Int32MultiArray(data=[1, 2]))).endswith('data: [1, 2]')
