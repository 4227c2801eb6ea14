"""All that a learner can read: the words of exercises and quizzes, and the prose of notebooks."""

from __future__ import annotations

from collections.abc import Iterator

from labkit.errors import LabError
from labkit.exercises.words import ROOT, files, sentences
from labkit.files import read_json

__all__ = ['all_words']


def all_words() -> Iterator[str]:
    """Return a line for each sentence or paragraph: its file, where it stands there, the text."""
    for path in files():
        for key, text in sentences(path).items():
            yield f'{path.relative_to(ROOT.parent)}\t{key}\t{" ".join(text.split())}'
    notebooks = sorted((ROOT.parent / 'notebooks').glob('*.ipynb'))
    if not notebooks:
        raise LabError(f'There are no notebooks beside {ROOT}.', todo='Run it in a clone.')
    for path in notebooks:
        for cell in read_json(path)['cells']:
            if cell['cell_type'] == 'markdown':
                for text in ''.join(cell['source']).split('\n\n'):
                    place = f'{path.relative_to(ROOT.parent)}\t{cell["id"]}'
                    yield f'{place}\t{" ".join(text.split())}'
