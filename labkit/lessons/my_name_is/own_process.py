"""Exercise: the first stage as a program of its own."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, NotAttempted, words_of
from labkit.exercises.clauses import Evidence, GraphClause, Publishes
from labkit.exercises.machine_faults import refuse_machine_fault
from labkit.lessons.my_name_is.programs import ended_program
from labkit.lessons.my_name_is.stages import INNER, STRING, says_opening

__all__ = ['exercise']

WORDS = words_of(__file__)

IN_THE_NOTEBOOK = WORDS.mistake('own-process/in-the-notebook')
FAILED = WORDS.mistake('own-process/failed')
ENDED = WORDS.mistake('own-process/ended')


class _InAnotherProcess(GraphClause):
    """The publisher is not in this notebook's process."""

    text = WORDS.clause('in-another-process')

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
    words=WORDS,
    clauses=(_InAnotherProcess(), Publishes(INNER, 2.0, STRING), says_opening()),
)
