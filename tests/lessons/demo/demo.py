"""A small lesson with the engine's whole range, to prove the harness and the engine with."""

from __future__ import annotations

from typing import Any

from labkit.exercises import (
    Choice,
    Exercise,
    Lesson,
    Outcome,
    Probe,
    Quiz,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
    right,
    wrong,
)

INT16 = 'std_msgs/msg/Int16'
STRING = 'std_msgs/msg/String'

NODE = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int16, Int32, String

class OddPublisher(Node):
    def __init__(self):
        super().__init__('odd_publisher')
        self.publisher = self.create_publisher(Int16, 'demo_odds', 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.number = 1

    def on_timer(self):
        msg = Int16()
        msg.data = self.number
        self.publisher.publish(msg)
        self.number += 2

lab.spin(OddPublisher())
"""


def judge_count_up(probe: Probe) -> str:
    source = expect.publisher(probe, '/demo_odds')
    odds = expect.messages(probe, source, count=4, hz=10.0)
    expect.each(
        odds,
        'data',
        lambda value: value % 2 == 1,
        expected='odd numbers: 1, 3, 5, ...',
        why='These are even numbers. Adding 2 keeps a number odd only if the first one is odd.',
        todo='Start with 1.',
    )
    expect.steps(odds, 'data', 2)
    expect.first(odds, 'data', 1, 2, why='The count starts with another number than 1.')
    expect.node(probe, '/odd_publisher')
    return f'{source.node} sent {expect.show(odds.values("data"))}'


count_up = Exercise(
    name='count_up',
    task='A node `odd_publisher` that publishes 1, 3, 5, ... on /demo_odds, ten a second.',
    publishes={'/demo_odds': INT16},
    nodes=['/odd_publisher'],
    judge=judge_count_up,
    hints=['Which line runs again and again?', 'A timer of 0.1 s, and self.number += 2.'],
    answer=Solution(NODE, 'The number lives in the node, so it outlives the callback.'),
    styles=[
        Style(
            'functions and a thread',
            """
import threading
import time
import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('odd_publisher')
publisher = node.create_publisher(Int16, '/demo_odds', 10)

def work():
    for value in range(1, 3001, 2):
        if not rclpy.ok():
            break
        publisher.publish(Int16(data=value))
        time.sleep(0.1)

threading.Thread(target=work, daemon=True).start()
""",
        ),
        Style(
            'loop with a rate',
            """
import threading
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int16

def main():
    rclpy.init()
    node = Node('odd_publisher')
    publisher = node.create_publisher(Int16, 'demo_odds', 1)
    rate = node.create_rate(10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    value = -1
    while rclpy.ok():
        value = value + 2
        publisher.publish(Int16(data=value))
        rate.sleep()

threading.Thread(target=main, daemon=True).start()
""",
        ),
        Style(
            'main() in a process of its own',
            changed(
                NODE,
                (
                    'lab.spin(OddPublisher())',
                    """
def main():
    rclpy.init()
    rclpy.spin(OddPublisher())

main()
""",
                ),
            ),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'starts at 0',
            changed(NODE, ('self.number = 1', 'self.number = 0')),
            'These are even numbers.',
        ),
        Wrong(
            'starts at 3',
            changed(NODE, ('self.number = 1', 'self.number = 3')),
            'The count starts with another number than 1.',
        ),
        Wrong(
            'never counts',
            changed(NODE, ('self.number += 2', 'number = self.number + 2')),
            'Every message says the same',
        ),
        Wrong(
            'counts by 4',
            changed(NODE, ('self.number += 2', 'self.number += 4')),
            'The value changes by 4 and not by 2.',
        ),
        Wrong(
            'starts over',
            changed(NODE, ('self.number += 2', 'self.number = (self.number + 2) % 4')),
            'The values start over',
        ),
        Wrong(
            'ten times too slow',
            changed(NODE, ('create_timer(0.1,', 'create_timer(1.0,')),
            'times too slow',
        ),
        Wrong(
            'rate for period',
            changed(NODE, ('create_timer(0.1,', 'create_timer(10,')),
            'its period is 10 s',
        ),
        Wrong(
            'ten times too fast',
            changed(NODE, ('create_timer(0.1,', 'create_timer(0.01,')),
            'times too fast',
        ),
        Wrong(
            'capital letter',
            changed(NODE, ("'demo_odds'", "'demo_Odds'")),
            'Capital and small letters differ',
        ),
        Wrong(
            'private name',
            changed(NODE, ("'demo_odds'", "'~/demo_odds'")),
            'it lies in another namespace',
        ),
        Wrong(
            'misspelt',
            changed(NODE, ("'demo_odds'", "'demo_ods'")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'quite another name',
            changed(NODE, ("'demo_odds'", "'numbers'")),
            'The node works with a topic of another name',
        ),
        Wrong(
            'wrong type',
            changed(
                NODE,
                ("Int16, 'demo_odds'", "Int32, 'demo_odds'"),
                ('msg = Int16()', 'msg = Int32()'),
            ),
            'A topic carries one type of message.',
        ),
        Wrong(
            'forgot to publish',
            changed(NODE, ('self.publisher.publish(msg)', 'pass')),
            'publish() is not called there',
        ),
        Wrong(
            'publishes once',
            changed(
                NODE,
                ('self.timer = self.create_timer(0.1, self.on_timer)', ''),
                ('self.number = 1', 'self.number = 1; self.on_timer()'),
            ),
            'publish() ran once at most',
        ),
        Wrong(
            'not spun',
            changed(NODE, ('lab.spin(OddPublisher())', 'node = OddPublisher()')),
            'nothing runs its callbacks',
        ),
        Wrong(
            'callback called',
            changed(
                NODE,
                (
                    'self.create_timer(0.1, self.on_timer)',
                    'self.create_timer(0.1, self.on_timer())',
                ),
                ('self.number = 1\n', ''),
                (
                    "super().__init__('odd_publisher')",
                    "super().__init__('odd_publisher'); self.number = 1",
                ),
            ),
            'Pass the name alone, without brackets',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'publisher made in the callback',
            changed(
                NODE,
                (
                    '        msg = Int16()\n',
                    '        self.publisher = '
                    "self.create_publisher(Int16, 'demo_odds', 10)\n        msg = Int16()\n",
                ),
            ),
            'makes a publisher again and again',
        ),
        Wrong(
            'another node on the same topic',
            changed(
                NODE,
                (
                    'lab.spin(OddPublisher())',
                    """
lab.spin(OddPublisher())
other = Node('odd_publisher', namespace='copy')
again = other.create_publisher(Int16, '/demo_odds', 10)
""",
                ),
            ),
            '/copy/odd_publisher in this notebook',
        ),
        Wrong(
            'two copies',
            changed(
                NODE,
                (
                    'lab.spin(OddPublisher())',
                    """
rclpy.init()
copy = OddPublisher()
rclpy.spin(OddPublisher())
""",
                ),
            ),
            'Two copies of the node run at once',
            process=True,
        ),
        Wrong(
            'value of the wrong kind',
            changed(NODE, ('msg.data = self.number', 'msg.data = str(self.number)')),
            'takes values of type int',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'publishes a number',
            changed(NODE, ('self.publisher.publish(msg)', 'self.publisher.publish(msg.data)')),
            'publish() takes a message of the type',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'other node name',
            changed(NODE, ("'odd_publisher'", "'odds_publisher'")),
            'a node called /odd_publisher',
        ),
    ],
)

GREETER = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

class Greeter(Node):
    def __init__(self):
        super().__init__('greeter')
        self.publisher = self.create_publisher(String, 'demo_complete', 10)
        self.subscription = self.create_subscription(
            String, 'demo_incomplete', self.on_text, 10)

    def on_text(self, msg):
        self.get_logger().info(f'I heard: {msg.data}')
        reply = String(data=msg.data + 'Ada')
        self.publisher.publish(reply)

lab.spin(Greeter())
"""


def explain(sent: Any, came: list[Any]) -> tuple[str, str]:
    if came and not str(came[-1]).startswith(sent['data'].strip()):
        return 'The text that came in is not used.', 'Put msg.data before the name.'
    return '', ''


def judge_greet(probe: Probe) -> str:
    hears = expect.subscription(probe, '/demo_incomplete')
    says = expect.publisher(probe, '/demo_complete', by=hears.node)
    found = expect.replies(
        probe,
        hears,
        [{'data': 'My name is '}, {'data': 'I am '}],
        says,
        lambda sent: sent['data'] + 'Ada',
        explain=explain,
    )
    line = expect.logs(probe, hears.node, hears, {'data': 'Call me '}, 'Call me ')
    return f'{found[0].values[0]!r}, {line!r}'


greet = Exercise(
    name='greet',
    task='A node that adds Ada to each text of /demo_incomplete and logs what it heard.',
    subscribes={'/demo_incomplete': STRING},
    publishes={'/demo_complete': STRING},
    judge=judge_greet,
    hints=['The answer is sent in the callback.', 'reply.data = msg.data + "Ada"'],
    answer=Solution(GREETER, 'The callback is where the text is.'),
    styles=[
        Style(
            'functions',
            """
from std_msgs.msg import String
import rclpy
node = rclpy.create_node('another_name')
pub = node.create_publisher(String, '/demo_complete', 1)
def answer(m):
    pub.publish(String(data='%sAda' % m.data))
    node.get_logger().warning('got ' + m.data)
node.create_subscription(String, '/demo_incomplete', answer, 1)
lab.spin(node)
""",
        ),
        Style(
            'main() in a process of its own',
            changed(GREETER, ('lab.spin(Greeter())', 'rclpy.init()\nrclpy.spin(Greeter())')),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'space missing',
            changed(GREETER, ("msg.data + 'Ada'", "msg.data.strip() + 'Ada'")),
            'The spaces are not where they should be',
        ),
        Wrong(
            'made once',
            changed(GREETER, ("msg.data + 'Ada'", "'My name is Ada'")),
            'The text that came in is not used.',
        ),
        Wrong(
            'answers where it listens',
            changed(GREETER, ("'demo_complete'", "'demo_incomplete'")),
            'The node hears what it says itself',
        ),
        Wrong(
            'does not publish',
            changed(GREETER, ('self.publisher.publish(reply)', '')),
            'its callback did not publish',
        ),
        Wrong(
            'blocks',
            changed(
                GREETER, ('        reply =', '        import time; time.sleep(3)\n        reply =')
            ),
            'While a callback runs, no other one can',
        ),
        Wrong(
            'does not log',
            changed(
                GREETER, ("self.get_logger().info(f'I heard: {msg.data}')", 'print(msg.data)')
            ),
            'The callback does not log',
        ),
        Wrong(
            'callback without a message',
            changed(GREETER, ('def on_text(self, msg)', 'def on_text(self)')),
            'This callback does not take one argument',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'no publisher',
            changed(GREETER, ("self.create_publisher(String, 'demo_complete', 10)", 'None')),
            'create_publisher() for this topic has not been called',
        ),
        Wrong(
            'raises in the callback',
            changed(GREETER, ('msg.data +', 'msg.text +')),
            'String has nothing called text',
            outcome=Outcome.ERROR,
        ),
    ],
)


def judge_goodbye(probe: Probe) -> str:
    source = expect.publisher(probe, '/demo_speed')
    speeds = expect.messages(probe, source, count=2)
    expect.each(speeds, 'data', lambda v: v == 1.0, expected='1.0 while it runs')
    last = expect.ends_with_node(probe, source)
    expect.that(
        last.values('data')[-1] == 0.0,
        expected='0.0 as the last message',
        seen=f'{last.values("data")[-1]!r}',
        why='The node ends without a word, and whoever listens goes on with the last speed.',
    )
    return 'Its last word was 0.0.'


SPEED = """
from rclpy.node import Node
from std_msgs.msg import Float64

class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.publisher = self.create_publisher(Float64, 'demo_speed', 10)
        self.create_timer(0.05, lambda: self.publisher.publish(Float64(data=1.0)))

    def destroy_node(self):
        self.publisher.publish(Float64(data=0.0))
        super().destroy_node()

lab.spin(Driver())
"""

goodbye = Exercise(
    name='goodbye',
    task='A node that publishes 1.0 on /demo_speed, and 0.0 as its last word.',
    publishes={'/demo_speed': 'std_msgs/msg/Float64'},
    judge=judge_goodbye,
    hints=['What is called when a node ends?', 'destroy_node()'],
    answer=Solution(SPEED, 'destroy_node() is called whatever ends the node.'),
    styles=[
        Style(
            'main() in a process of its own',
            changed(
                SPEED,
                ('lab.spin(Driver())', ''),
                ('from rclpy.node', 'import time\nimport rclpy\nfrom rclpy.node'),
                # What is said last takes a moment to be heard in another process.
                ('        super().destroy', '        time.sleep(0.3)\n        super().destroy'),
            )
            + """
rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
node = Driver()
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
finally:
    node.destroy_node()
""",
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'ends silently',
            changed(SPEED, ('self.publisher.publish(Float64(data=0.0))', 'pass')),
            'The node ends without a word',
        ),
    ],
    once=True,
)


def judge_say_once(probe: Probe) -> str:
    heard = probe.recorded['/demo_news'].values('data')
    if not heard:
        source = expect.publisher(probe, '/demo_news')
        expect.messages(probe, source, count=1)
    expect.that(
        heard[-1:] == ['late'],
        expected="the text 'late'",
        seen=repr(heard[-1]),
        why='Another text was published.',
    )
    expect.that(
        len(heard) == 1,
        expected='one message',
        seen=f'{len(heard)} messages',
        why='It was published more than once.',
    )
    return 'One message, once.'


SAY = """
import rclpy
from std_msgs.msg import String
node = rclpy.create_node('once')
pub = node.create_publisher(String, 'demo_news', 10)
pub.publish(String(data='late'))
"""

say_once = Exercise(
    name='say_once',
    task='Publish the text late on /demo_news, once.',
    publishes={'/demo_news': STRING},
    judge=judge_say_once,
    hints=['publish() without a timer', 'pub.publish(String(data="late"))'],
    answer=Solution(SAY, 'Nothing more is needed: somebody listens already.'),
    styles=[Style('node gone again', SAY + 'node.destroy_node()\n')],
    wrong=[
        Wrong('twice', SAY + "pub.publish(String(data='late'))\n", 'more than once'),
        Wrong('other text', changed(SAY, ("'late'", "'Late'")), 'Another text was published'),
        Wrong(
            'never', changed(SAY, ("pub.publish(String(data='late'))", '')), 'no loop publishes'
        ),
    ],
    records=['/demo_news'],
)

LESSON = Lesson(
    'demo',
    'demo.ipynb',
    exercises=[count_up, greet, goodbye, say_once],
    quizzes=[
        Quiz(
            'numbers',
            Choice(
                'Which of these is odd?',
                right('3', '3 is not a multiple of 2.'),
                wrong('4', '4 is 2 times 2.'),
                wrong('0', '0 is 0 times 2, so it is even.'),
            ),
        )
    ],
    topics=['/demo_background'],
    given=['/background'],
)
