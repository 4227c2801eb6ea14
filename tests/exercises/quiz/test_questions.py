from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest

from labkit.errors import LabError
from labkit.exercises import Choice, Number, Quiz, Several, Word, right, words_of, wrong
from labkit.exercises.found_lessons import all_lessons, load
from labkit.exercises.quiz import spelling
from labkit.exercises.quiz.questions import Feedback, Question
from labkit.exercises.record.progress_store import progress_store

ODD = Choice(
    'Which is odd?',
    right('three', 'Because of 3.'),
    wrong('four', 'Four is even.'),
    wrong('zero', 'Zero is even.'),
)
ODDS = Several(
    'Which are odd?',
    right('three', 'Because of 3.'),
    right('five', 'Because of 5.'),
    wrong('four', 'Four is even.'),
)
RATE = Number(
    'How many a second?',
    10.0,
    'The period is 0.1 s.',
    'Divide 1 by the period.',
    wrong={0.1: 'This is the period.'},
    tolerance=0.05,
    unit='Hz',
)
NODE = Word('Who publishes?', lambda: ['/talker', '/other'], 'It is there.', 'Look at the graph.')


def letter(question: Choice | Several, *texts: str) -> str:
    return ''.join('abc'[question.labels().index(text)] for text in texts)


def test_right_choice_explains_all_answers() -> None:
    feedback = ODD.judge(letter(ODD, 'three').upper())
    assert feedback.is_right
    assert feedback.lines[0] == (letter(ODD, 'three'), 'Because of 3.')
    assert sorted(why for _, why in feedback.lines) == sorted(o.why for o in ODD.options)


def test_wrong_choice_explains_itself_and_gives_nothing_away() -> None:
    feedback = ODD.judge(letter(ODD, 'four'))
    assert not feedback.is_right
    assert [why for _, why in feedback.lines] == ['Four is even.']


@pytest.mark.parametrize('given', ['d', '', 'aa b', 7, 'thre', None, [], ...])
def test_what_is_no_choice_is_said(given: object) -> None:
    with pytest.raises(LabError):
        ODD.judge(given if given != 'aa b' else 'ab')


def test_choice_is_made_by_a_letter_however_it_is_typed_or_by_its_text() -> None:
    b = letter(ODD, 'three')
    for given in (b, b.upper(), f'{b})', f'({b})', f' {b}. ', f"'{b}'", 'three', 'Three.', [b]):
        assert ODD.judge(given).is_right, given
    one, other = letter(ODDS, 'three'), letter(ODDS, 'five')
    for joint in ('', ', ', ' ', '; ', ' and ', '+', ' & '):
        assert ODDS.judge(f'{one}{joint}{other}').is_right, joint
    assert ODDS.judge(['three', 'five']).is_right


def test_several_needs_all_and_only_the_right_ones() -> None:
    assert ODDS.judge(letter(ODDS, 'five', 'three')).is_right
    assert ODDS.judge(list(letter(ODDS, 'five', 'three'))).is_right
    missing = ODDS.judge(letter(ODDS, 'five'))
    assert not missing.is_right and 'One right answer' in missing.lines[-1][1]
    assert 'Because' not in str(missing.lines)
    too_many = ODDS.judge(letter(ODDS, 'five', 'three', 'four'))
    assert [why for _, why in too_many.lines] == ['Four is even.']


@pytest.mark.parametrize('given', [10, 10.4, '10', ' 9,6 '])
def test_number_within_tolerance_is_right(given: object) -> None:
    assert RATE.judge(given).is_right


def test_wrong_number_is_explained() -> None:
    assert RATE.judge(0.1).lines == [('why', 'This is the period.')]
    assert RATE.judge(5).lines == [('why', 'Divide 1 by the period.')]
    with pytest.raises(LabError, match='must be a number'):
        RATE.judge('many')


def test_word_is_read_off_when_it_is_asked() -> None:
    assert NODE.judge("'/other' ").is_right
    assert NODE.judge('/nobody').lines == [('why', 'Look at the graph.')]


def test_quiz_as_text_is_the_same_each_time() -> None:
    quiz = Quiz('numbers', ODD, ODDS, RATE, NODE)
    assert repr(quiz) == repr(Quiz('numbers', ODD, ODDS, RATE, NODE))
    lines = repr(quiz).splitlines()
    assert lines[1] == ' 1. Which is odd? (one answer)'
    assert ' 3. How many a second? (a number, in Hz)' in lines
    assert len(lines) == 1 + 4 + 4 + 1 + 1


def test_answers_are_counted(home: Path) -> None:
    quiz = Quiz('numbers', ODD, RATE)
    quiz.lesson = 'odds'
    assert 'NOT YET' in repr(quiz.answer(2, 5))
    assert 'RIGHT' in repr(quiz.answer(2, 10))
    questions = progress_store.store.read()[0]['lessons']['odds']['questions']
    assert questions['numbers.2']['tries'] == 2 and questions['numbers.2']['passed_at']
    with pytest.raises(LabError, match='1 to 2'):
        quiz.answer(3, 'a')


def test_without_widgets_a_quiz_is_text(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, 'labkit.views.quiz_form', None)
    assert Quiz('numbers', ODD)._repr_mimebundle_() == {'text/plain': repr(Quiz('numbers', ODD))}


def asked(lesson: str, quiz: str, number: int) -> Question:
    return load(lesson).quiz(quiz).questions[number - 1]


def why(feedback: Feedback) -> str:
    return feedback.lines[0][1]


PIER = Word('Which node?', '/pier_east', 'So it is.', 'Look again.')
TYPE = Word(
    'Which type?',
    'sensor_msgs/msg/Temperature',
    'So it is.',
    'Look again.',
    form=spelling.type_name('msg'),
)
SERVICE = Word('?', 'std_srvs/srv/SetBool', 'Yes.', 'No.', form=spelling.type_name('srv'))
FIELD = Word('Which field?', 'fluid_pressure', 'Yes.', 'Look.', form=spelling.field_name)
OFFERED = Word('Which QoS?', 'RELIABLE', 'Yes.', 'Look.', form=spelling.constant)
OTHER = Word('Which QoS?', 'BEST_EFFORT', 'Yes.', 'Look.', form=spelling.constant)
SHOW = asked('command_line', 'commands', 4)
LEGS = asked('theory', 'theory', 12)
FORTY = asked('talker_listener', 'talker_listener', 5)
FIVE = asked('my_name_is', 'my_name_is', 4)
SMALL = asked('odds', 'odds', 3)
LOST = asked('odds', 'odds', 4)
RADIAN = asked('turtlebot', 'turtlebot', 3)
BEACON = Number('?', 4, 'Yes.', 'Look.', tolerance=0.11, unit='Hz')

RIGHT: list[tuple[Question, list[object]]] = [
    (PIER, ['/pier_east', 'pier_east', ' pier_east ', '"/pier_east"', "'pier_east'"]),
    (PIER, ['`/pier_east`', '\u201c/pier_east\u201d', 'pier_east.', '/pier_east/', '/ pier_east']),
    (PIER, ['Node name: pier_east', 'the node /pier_east', 'node pier_east', 'pier_east\n']),
    (
        TYPE,
        ['sensor_msgs/msg/Temperature', 'sensor_msgs/Temperature', '[sensor_msgs/Temperature]'],
    ),
    (TYPE, ['Type: sensor_msgs/msg/Temperature', '/sensor_msgs/msg/Temperature.']),
    (TYPE, ['sensor_msgs / msg / Temperature', "'sensor_msgs/Temperature'"]),
    (SERVICE, ['std_srvs/srv/SetBool', 'std_srvs/SetBool', '"std_srvs/srv/SetBool" ']),
    (FIELD, ['fluid_pressure', 'fluid_pressure: 12.5', 'msg.fluid_pressure', '.fluid_pressure']),
    (FIELD, ['float64 fluid_pressure', 'the field fluid_pressure', '"fluid_pressure"']),
    (OFFERED, ['RELIABLE', 'Reliable', 'reliable', ' reliable. ', 'Reliability: RELIABLE']),
    (OFFERED, ['ReliabilityPolicy.RELIABLE', 'RMW_QOS_POLICY_RELIABILITY_RELIABLE', "'Reliable'"]),
    (
        OTHER,
        ['BEST_EFFORT', 'best effort', 'Best Effort', 'best-effort', 'besteffort', 'Best_effort'],
    ),
    (
        SHOW,
        [
            'interface show',
            'Interface Show',
            'INTERFACE SHOW',
            'interface  show',
            'interface show.',
        ],
    ),
    (SHOW, ['ros2 interface show', '%ros2 interface show', '$ ros2 interface show']),
    (SHOW, ['!ros2 interface show', '`ros2 interface show`', 'interface, show']),
    (
        SHOW,
        ['ros2 interface show std_msgs/msg/String', '"interface" "show"', 'interface and show'],
    ),
    (
        LEGS,
        [
            '/move',
            'move',
            '"/move"',
            'move.',
            ' /move ',
            'the topic /move',
            'topic move',
            '/move/',
        ],
    ),
    (FORTY, [40, 40.0, '40', ' 40 ', '40 messages', '40.', '40,0', 'about 40', '4e1', "'40'"]),
    (
        FIVE,
        [
            5,
            '5',
            '5 Hz',
            '5Hz',
            '5 hertz',
            '5.0',
            '5,0 Hz',
            'five',
            '5/s',
            '5 1/s',
            '5 per second',
        ],
    ),
    (FIVE, ['5 messages a second', '5 messages per second', '5 a second', '5 Hz.', '~5 Hz']),
    (SMALL, [-32767, '-32767', '\u221232767', '-32 767', '-32,767', 'minus 32767', '- 32767']),
    (LOST, [15, '15', 'fifteen', '15 messages', 'Fifteen', '15.0', '15 are lost']),
    (RADIAN, [1, 1.0, '1', '1.0', '1,0', '1 rad', '1.0 radians', 'one', '1.00 rad.']),
    (BEACON, ['4,4', '4.2 Hz', ' 4 ', '3.998', 'average rate: 4.001', '4', 'four', '3,99 hertz']),
    (ODD, ['three', 'Three', '"three"']),
]

WRONG: list[tuple[Question, object, str]] = [
    (PIER, '/Pier_East', 'Capital and small letters differ'),
    (PIER, 'pier east', 'An underscore is part of the name'),
    (PIER, 'piereast', 'An underscore is part of the name'),
    (PIER, '/pier_esat', 'letter by letter'),
    (PIER, '/boat_a', 'Look again.'),
    (TYPE, 'sensor_msgs/msg/temperature', 'Capital and small letters differ'),
    (TYPE, 'sensor_msgs/msg/Temprature', 'letter by letter'),
    (TYPE, 'std_msgs/msg/String', 'Look again.'),
    (TYPE, 'sensor_msgs/Imu', 'Look again.'),
    (TYPE, 'sensor_msg/msg/Temperature', 'letter by letter'),
    (FIELD, 'Fluid_Pressure', 'Capital and small letters differ'),
    (FIELD, 'fluid pressure', 'An underscore is part of the name'),
    (OFFERED, 'best effort', 'Look.'),
    (SHOW, 'interface list', 'the names of all types'),
    (SHOW, 'ros2 interface list', 'the names of all types'),
    (SHOW, 'Topic Type', 'names the type of a topic'),
    (SHOW, 'topic info /chatter', 'names the type of a topic'),
    (SHOW, 'ros2 msg show', 'It is interface now'),
    (SHOW, 'interface', 'one of the two words'),
    (SHOW, 'show interface', 'The command comes first'),
    (SHOW, 'interface proto', 'an empty message to copy'),
    (SHOW, 'node info', 'Look into the table'),
    (LEGS, 'sight', 'what the brain listens to'),
    (LEGS, '/Sight', 'Draw the graph'),
    (LEGS, 'Move', 'Capital and small letters differ'),
    (LEGS, '/mvoe', 'letter by letter'),
    (LEGS, '/sneeze', 'a service'),
    (LEGS, 'left_leg', 'That is a leg'),
    (FORTY, '2,5', 'You divided.'),
    (FORTY, '0.25 s', 'the period in seconds'),
    (FORTY, '400', 'Four messages in each second'),
    (FIVE, '10 Hz', 'only five times'),
    (FIVE, '2', '10 times 0.2'),
    (FIVE, '50 hertz', '10 divided by 0.2'),
    (SMALL, '32769', 'does not fit into 16 bits'),
    (SMALL, '32,767', 'Nothing is cut off'),
    (SMALL, '-32768', 'one step further'),
    (LOST, 'five', 'how many are heard'),
    (LOST, '0', 'A queue has an end'),
    (RADIAN, '57.3 degrees', 'the angle in degrees'),
    (RADIAN, '57.2958', 'the angle in degrees'),
    (RADIAN, '0,5', 'what it turns in one second'),
    (RADIAN, '4', 'You divided.'),
    (BEACON, '4,5 Hz', 'Look.'),
    (BEACON, '5 Hz', 'Look.'),
]

NO_ANSWER: list[tuple[Question, object, str]] = [
    (PIER, '', 'in quotation marks'),
    (PIER, ' / ', 'in quotation marks'),
    (PIER, None, 'in quotation marks'),
    (PIER, 4, 'in quotation marks'),
    (SHOW, '""', 'two words'),
    (FIVE, '0.2 s', "a number in Hz, but the unit of '0.2 s' is 's'"),
    (FIVE, '5 kHz', "is 'khz'"),
    (FIVE, 'many', 'must be a number'),
    (FIVE, '', 'must be a number'),
    (FIVE, 'nan', 'must be a number'),
    (FIVE, 'inf', 'must be a number'),
    (FIVE, '4 or 5', "is 'or 5'"),
    (FIVE, '1.2.3', 'must be a number'),
    (FIVE, None, 'must be a number'),
    (FIVE, True, 'must be a number'),
]


@pytest.mark.parametrize(
    ('question', 'given'), [(question, given) for question, all_ in RIGHT for given in all_]
)
def test_what_is_right_in_substance_is_right(question: Question, given: object) -> None:
    assert question.judge(given).is_right


@pytest.mark.parametrize(('question', 'given', 'says'), WRONG)
def test_what_is_wrong_is_told_what_fits(question: Question, given: object, says: str) -> None:
    feedback = question.judge(given)
    assert not feedback.is_right
    assert says in why(feedback)


@pytest.mark.parametrize(('question', 'given', 'says'), NO_ANSWER)
def test_what_is_no_answer_is_said(question: Question, given: object, says: str) -> None:
    with pytest.raises(LabError) as caught:
        question.judge(given)
    assert says in str(caught.value)


def test_known_wrong_answers_are_told_apart_from_the_right_one() -> None:
    for lesson in all_lessons():
        for quiz in lesson.quizzes:
            for question in quiz.questions:
                if isinstance(question, (Number, Word)) and not callable(question.answer):
                    for given, reason in question.wrong.items():
                        assert why(question.judge(given)) == reason, (lesson.name, given)


LIVE = [
    ('theory', 'theory', 11, 'Run the cell with the class Eye'),
    ('odds', 'odds', 6, 'Run the cell with open_stadium()'),
    ('my_name_is', 'my_name_is', 5, 'Run the cell with your StageTwo'),
]


@pytest.mark.parametrize(('lesson', 'quiz', 'number', 'says'), LIVE)
def test_live_question_after_stop_says_which_cell_to_run(
    lesson: str, quiz: str, number: int, says: str, lab: ModuleType
) -> None:
    lab.stop()
    feedback = asked(lesson, quiz, number).judge(2)
    assert not feedback.is_right
    assert says in why(feedback)


@pytest.mark.parametrize('number', range(1, 9))
def test_harbour_question_after_stop_says_which_cell_to_run(number: int, lab: ModuleType) -> None:
    lab.stop()
    with pytest.raises(LabError, match=r'(?s)The harbour is closed.*open_harbour\(\)'):
        asked('command_line', 'harbour', number).judge('4')


QUESTIONS = """
quizzes:
  odds:
    - several: Which are odd?
      options:
        - right: 1
          why: It has a rest.
        - wrong: 2
          why: It has none.
        - right: 3
          why: It has one.
    - number: How many are there?
      id: count
      why: Count them.
      otherwise: Count.
      wrong:
        -2: It is below zero.
        0.5: That is a half.
    - word: What is /odds?
      answer: topic
      how: one word
      why: It carries messages.
      otherwise: Look.
"""


def quiz_of(folder, text, **live):
    (folder / 'quiz.yaml').write_text(text)
    return Quiz.of(words_of(str(folder / 'quiz.py')), 'odds', **live)


def test_questions_are_written_as_words(tmp_path):
    quiz = quiz_of(tmp_path, QUESTIONS, count={'answer': lambda: 3})
    several, number, word = quiz.questions
    assert {option.text for option in several.options if option.is_right} == {'1', '3'}
    assert number.judge('3').is_right and dict(number.judge('-2').lines) == {
        'why': 'It is below zero.'
    }
    assert number.wrong == {-2: 'It is below zero.', 0.5: 'That is a half.'}
    assert word.judge('topic').is_right and word.how == 'one word'


@pytest.mark.parametrize(
    ('text', 'said'),
    [
        (QUESTIONS.replace('id: count', 'id: number'), r"\['count'\] is expected .*\['number'\]"),
        (QUESTIONS.replace('  odds:', '  even:'), 'no such quiz'),
        (QUESTIONS.replace('word: What', 'unit: What'), 'a question is a choice, several'),
        (QUESTIONS.replace('several:', 'choice:'), "'Which are odd\\?' has 2 right options"),
        (QUESTIONS.replace('      answer: topic\n', ''), "'What is /odds\\?' has no 'answer'"),
        (QUESTIONS.replace('-2: It', 'two: It'), 'two'),
        (QUESTIONS.replace('several:', 'seveal:'), "line 4: odds has no 'seveal'"),
    ],
)
def test_what_is_no_question_is_refused(tmp_path, text, said):
    with pytest.raises(LabError, match=said):
        quiz_of(tmp_path, text, count={'answer': lambda: 3})
