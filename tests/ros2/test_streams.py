"""`ros2 topic echo|hz|bw|delay|pub` against foreign nodes."""

from __future__ import annotations

import re

import pytest

pytestmark = pytest.mark.usefixtures('robot')


def test_echo_shows_messages_as_yaml(ros2):
    message, part, number, two = ros2(
        'topic echo --once /chatter',
        'topic echo /odom --once --field pose.pose.position',
        'topic echo /odom --once --field pose.pose.position.x',
        'topic echo /chatter std_msgs/msg/String --count 2',
    )
    assert re.fullmatch(r'data: Hello \d+\n---\n', message.out)
    assert part.out == 'x: 1.5\ny: 0.0\nz: 0.0\n---\n'
    assert number.out == '1.5\n---\n'
    first, second = (int(number) for number in re.findall(r'Hello (\d+)', two.out))
    assert second == first + 1


@pytest.mark.slow('starts other processes')
def test_echo_shows_less_or_in_another_form(ros2):
    short, words, full, flow, csv, no_text, info, info_csv, raw = ros2(
        'topic echo /scan --once --field ranges --truncate-length 3',
        'topic echo /odom --once --no-arr',
        'topic echo /scan --once -f --flow-style',
        'topic echo /chatter --once --flow-style',
        'topic echo /odom --once --csv --field pose.pose',
        'topic echo /chatter --once --no-str',
        'topic echo /chatter --once -i',
        'topic echo /chatter --once -i --csv',
        'topic echo /chatter --once --raw',
    )
    assert short.out.startswith('array(')
    assert "  covariance: '<array type: double[36]>'" in words.lines
    assert full.out.count('1.0') == 200 and '...' not in full.out
    assert re.fullmatch(r'data: Hello \d+\n---\n', flow.out)
    assert 'intensities: []' in full.lines and '  stamp:' in full.lines
    assert csv.out == '1.5,0.0,0.0,0.0,0.0,0.0,1.0\n'
    assert re.fullmatch(r"data: '<string length: <\d+>>'\n---\n", no_text.out)
    assert re.fullmatch(
        r'publication_sequence_number: \d+\nreceived_timestamp: \d+\n'
        r'reception_sequence_number: null\nsource_timestamp: \d+\n---\ndata: Hello \d+\n---\n',
        info.out,
    )
    assert re.fullmatch(r'\d+,\d+,\d+,None,Hello \d+\n', info_csv.out)
    assert re.fullmatch(r"b'\\x00\\x01.*Hello.*'\n---\n", raw.out)


def test_echo_cuts_long_arrays(ros2):
    (message,) = ros2('topic echo /scan --once')
    assert message.out.count('- 1.0') == 128
    assert "- '...'" in message.lines


@pytest.mark.slow('starts other processes')
def test_echo_says_what_is_wrong(ros2):
    field, kind, topic, silent, quiet = ros2(
        'topic echo /odom --field pose.pose.postion',
        'topic echo /chatter std_msgs/msg/Strin',
        'topic echo /chater --timeout 0.2',
        'topic echo /cmd_vel --timeout 0.2',
        'topic echo /scan --qos-reliability reliable --timeout 0.001',
    )
    assert field.err == (
        "Invalid field 'pose.pose.postion': nav_msgs/msg/Odometry has none.\n"
        "Did you mean 'pose.pose.position'?\n"
    )
    assert kind.err.endswith("Did you mean 'std_msgs/msg/String'?\n")
    assert topic.out == (
        "WARNING: topic [/chater] does not appear to be published yet\nDid you mean '/chatter'?\n"
    )
    assert 'Nobody publishes on /cmd_vel' in silent.err
    assert 'offering incompatible QoS. No messages will be received from it.' in quiet.out
    assert 'QoS profile does not match' in quiet.err


EVEN = 'int(m.data.rpartition(\\" \\")[-1]) % 2 == 0'


def test_echo_shows_what_passes_a_filter(ros2):
    even, part, none, wrong, no_value, code = ros2(
        f'topic echo /chatter --filter "{EVEN}" --count 2',
        'topic echo /odom --field pose.pose.position --filter "m.x > 1" --once',
        'topic echo /chatter --filter "m.data == \'nothing\'" --timeout 1',
        'topic echo /chatter --filter "m.dta"',
        'topic echo /scan --filter "m.ranges[500] > 0"',
        'topic echo /chatter --filter "__import__(\'os\')"',
    )
    first, second = (int(number) for number in re.findall(r'Hello (\d+)', even.out))
    assert first % 2 == 0 and second == first + 2
    assert part.out == 'x: 1.5\ny: 0.0\nz: 0.0\n---\n'
    assert re.fullmatch(
        r"\d+ messages came, and for none is m\.data == 'nothing' true\.\n", none.err
    )
    assert wrong.err == "m.dta: 'dta' is no field of a String.\nDid you mean 'data'?\n"
    assert (no_value.code, no_value.out) == (1, '') and 'index out of range' in no_value.err
    assert (code.code, code.out) == (1, '') and 'is not allowed in it.' in code.err


LATE = """
import sys, threading
import labkit as lab
from labkit.ros2.shell import run_line
from rclpy.node import Node
from std_msgs.msg import Int16

class Out:
    said = False

    def write(self, text):
        sys.__stdout__.write(text)
        if 'WARNING' in text and not self.said:
            self.said = True
            threading.Thread(target=publish).start()

    def flush(self):
        sys.__stdout__.flush()

def publish():
    node = lab.spin(Node('late'))
    publisher = node.create_publisher(Int16, '/late', 10)
    node.create_timer(0.05, lambda: publisher.publish(Int16(data=7)))

sys.stdout = Out()
sys.exit(run_line('topic echo /late --once --timeout 30'))
"""


@pytest.mark.slow('starts other processes')
def test_echo_waits_for_a_topic_that_does_not_exist_yet(script, domain):
    result = script(LATE, **domain)
    assert result.stdout == (
        'WARNING: topic [/late] does not appear to be published yet\ndata: 7\n---\n'
    )
    assert result.exit_code == 0


@pytest.mark.slow('rates, in real time')
def test_rates(ros2):
    hz, some, wrong, bw, delay, headless, no_delay, no_bw, no_header = ros2(
        'topic hz /chatter --count 2 --window 1',
        f'topic hz /chatter --count 1 --filter "{EVEN}"',
        'topic hz /scan --filter "m.ranges[500] > 0"',
        'topic bw scan --count 1',
        'topic delay /odom --count 1',
        'topic hz /nothing --timeout 0.1',
        'topic delay nothing --timeout 0.1',
        'topic bw /nothing --timeout 0.1',
        'topic delay /chatter --count 1',
    )
    # A report comes after a second, however few messages came in it: one interval is enough.
    report = r'average rate: \d+\.\d{3}\n\tmin: \d+\.\d{3}s max: \d+\.\d{3}s std dev: 0\.0{5}s'
    assert re.fullmatch(f'({report} window: 1\n){{2}}', hz.out)
    # Of twenty messages a second every second one.
    assert 0 < float(some.out.split()[2]) < 15
    assert (wrong.code, wrong.out) == (1, '') and 'index out of range' in wrong.err
    amount = r'[\d.]+ K?B'
    assert re.fullmatch(
        rf'Subscribed to \[scan\]\n{amount}/s from \d+ messages\n'
        rf'\tMessage size mean: {amount} min: {amount} max: {amount}\n',
        bw.out,
    )
    assert re.fullmatch(
        r'average delay: \d+\.\d{3}\n\tmin: -?\d+\.\d{3}s max: \d+\.\d{3}s std dev: \d+\.\d{5}s '
        r'window: \d+\n',
        delay.out,
    )
    assert headless.code == 1 and 'has not appeared' in headless.err
    # The name as it was typed, as with the real one.
    words = 'WARNING: topic [{}] does not appear to be published yet\n'
    assert headless.out == no_bw.out == words.format('/nothing')
    assert no_delay.out == words.format('nothing')
    assert no_header.err.startswith('msg does not have header\n')


def test_pub_reaches_a_node_of_another_process(ros2):
    # Each pub waits until its message has come, not until the callback has run. The robot takes a
    # message before it answers, and another one before the next answer.
    answered = ['param list /fleet/robot'] * 4
    answers = ros2(
        'topic pub --once /odds std_msgs/msg/Int16 "{data: 1}"',
        'topic pub -1 /odds std_msgs/Int16 "data: 3"',
        "topic pub --times 2 --rate 20 /odds std_msgs/msg/Int16 '{data: 5}'",
        *answered,
        'topic echo /heard --once --timeout 60',
    )
    assert not any(answer.code for answer in answers), answers
    assert answers[0].out == (
        'publisher: beginning loop\npublishing #1: std_msgs.msg.Int16(data=1)\n\n'
    )
    assert answers[2].out == (
        'publisher: beginning loop\n'
        'publishing #1: std_msgs.msg.Int16(data=5)\n\n'
        'publishing #2: std_msgs.msg.Int16(data=5)\n\n'
    )
    # The publisher keeps its last message for those who come late.
    assert answers[-1].out == 'data: 1,3,5,5\n---\n'


@pytest.mark.slow('starts other processes')
def test_pub_waits_for_subscribers_and_says_so(ros2):
    waiting, near, alone, several, default, pointless = ros2(
        'topic pub -w 1 --max-wait-time-secs 0.3 --once /nobody std_msgs/msg/Int16',
        'topic pub -w 1 --max-wait-time-secs 0.3 --once /Odds std_msgs/msg/Int16',
        'topic pub -w 0 --once --node-name me --print 0 /nobody std_msgs/msg/Int16',
        'topic pub -w 2 --max-wait-time-secs 0.3 --once /odds std_msgs/msg/Int16 --keep-alive 0.2',
        'topic pub --once --max-wait-time-secs 0.3 /nobody std_msgs/msg/Int16',
        'topic pub --max-wait-time-secs 0.3 /nobody std_msgs/msg/Int16 --timeout 0.1',
    )
    assert waiting.out == 'Waiting for at least 1 matching subscription(s)...\n'
    assert near.out == waiting.out + "Nobody subscribes to /Odds. Did you mean '/odds'?\n"
    assert waiting.err.startswith('Timed out waiting for subscribers: Expected 1 subscribers')
    assert (alone.code, alone.out) == (0, 'publisher: beginning loop\n')
    assert 'only got 1 subscribers' in several.err
    assert (default.out, default.err) == (waiting.out, waiting.err)
    assert 'only effective with --wait-matching-subscriptions, --once or --times' in pointless.err


WRONG = {
    '//odds std_msgs/msg/Int16 "{data: 1}"': "topic name must not contain repeated '/'.",
    '/odds std_msgs/msg/Int16 "{data: 40000}"': 'from -32768 to 32767, but got 40000.',
    '/odds std_msgs/msg/Int16 "{data: 1.5}"': 'whole number from -32768 to 32767',
    '/odds std_msgs/msg/Int16 "{dta: 1}"': "has no field 'dta'.\nDid you mean 'data'?",
    '/odds std_msgs/msg/Int16 "data:1"': 'A space is missing after the colon.',
    '/odds std_msgs/msg/Int16 "{data: 1"': 'can not be read as YAML',
    '/odds std_msgs/msg/Int16 "5"': 'needs to be a dictionary in YAML format',
    '/odds std_msgs/msg/Int16 ""': 'The passed value needs to be a dictionary in YAML format',
    '/odds std_msgs/msg/Int16 {data: 1}': 'YAML goes in quotation marks',
    '/odds std_msgs/msg/Int17': "Did you mean 'std_msgs/msg/Int16'?",
    '/odds std_srvs/srv/Trigger': 'The passed message type is invalid',
    '/cmd_vel geometry_msgs/msg/Twist "{linear: {x: fast}}"': "The 'linear.x' field must be a",
    '/cmd_vel geometry_msgs/msg/Twist "{linear: 5}"': 'needs a value for each field',
    '/o-d std_msgs/msg/Int16': 'is no name of a topic',
    '/odds std_msgs/msg/Int16 --rate 0': 'expected a number above 0',
    '/odds std_msgs/msg/Int16 --qos-reliability relable': "did you mean 'reliable'?",
    '/odds std_msgs/msg/Int16 --tmes 3': "Did you mean '--times'?",
    '/odds': 'the following arguments are required: message_type',
}


@pytest.mark.slow('starts other processes')
def test_pub_says_what_is_wrong(ros2):
    answers = ros2(*(f'topic pub --once {words}' for words in WRONG))
    for answer, (words, sentence) in zip(answers, WRONG.items(), strict=True):
        assert sentence in answer.err, words
        assert answer.code in (1, 2) and answer.out == '', words
        assert 'Traceback' not in answer.err
