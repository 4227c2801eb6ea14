"""Exercise: the first stage as a program of its own."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, Mistake, NotAttempted, Solution
from labkit.exercises.clauses import Evidence, GraphClause, Publishes
from labkit.exercises.machine_faults import refuse_machine_fault
from labkit.lessons.my_name_is.programs import ended_program
from labkit.lessons.my_name_is.stages import INNER, STRING, says_opening

__all__ = ['exercise']

IN_THE_NOTEBOOK = Mistake(
    'own-process/in-the-notebook',
    'lab.spin() runs a node in the process of this notebook.',
    'End it with lab.remove(...), and start a program with start_program(program).',
)
_AGAIN = 'Change the program, and run its cell again. That cell shows all that it says.'
FAILED = Mistake(
    'own-process/failed', 'An error has ended it. Its last line tells which one.', _AGAIN
)
ENDED = Mistake(
    'own-process/ended',
    'A program ends when its last line is done. rclpy.spin(node) in the last line keeps it going.',
    _AGAIN,
    change=[('rclpy.spin(Opener())', 'Opener()')],
)


class _InAnotherProcess(GraphClause):
    """The publisher is not in this notebook's process."""

    text = 'the publisher is in another process than this notebook'

    def find(self, evidence: Evidence) -> None:
        """Look where the publisher is."""
        try:
            one = evidence.publisher(INNER)
        except NotAttempted:
            program = ended_program(evidence.probe)
            if program is None:
                raise
            refuse_machine_fault(program.output, program.exit_code)
            last = program.output[-1] if program.output else 'nothing'
            raise Fail(
                f'a program that goes on, and publishes on {INNER}',
                f'a program that has ended, with exit code {program.exit_code}; its last line is: '
                f'{last}',
                FAILED if program.exit_code else ENDED,
            ) from None
        if evidence.probe.in_this_process(one):
            raise Fail(
                f'{INNER} with a publisher in a process of its own',
                f'{one.node} {evidence.probe.place(one)}',
                IN_THE_NOTEBOOK,
            )

    def judge(self, evidence: Evidence) -> str:
        """Say where it is."""
        one = evidence.publisher(INNER)
        return f'{one.node} runs {evidence.probe.place(one)}.'


exercise = Exercise(
    name='own_process',
    task="Publish 'My name is ' on /incomplete, twice a second, from a process of its own.",
    clauses=(_InAnotherProcess(), Publishes(INNER, 2.0, STRING), says_opening()),
    hints=[
        'The class of stage one stays as it is. What does a program need besides the class?',
        'Imports at the top; at the end rclpy.init() and rclpy.spin(...). lab is not needed '
        'there.',
        'Put all of it between the quotation marks, and remove the # from the last line.',
    ],
    answer=Solution(
        __file__,
        'own_process.py',
        'rclpy.init() starts ROS in the new process, and rclpy.spin() keeps it going. Stage two '
        'knows the topic only, so it does not matter to it in which process stage one runs. '
        'Before another process is started, the earlier one is ended: otherwise both would '
        'publish.',
    ),
)
