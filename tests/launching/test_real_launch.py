"""Each case was given to the real `launch` and `launch_ros` of Jazzy; this is equal.

`real_launch.json` has what they said and would have started, with parameter files as data. They
were read from source in an environment of their own; nothing of them is here.
"""

import json
from pathlib import Path
from typing import Any

import pytest

from labkit.errors import LabError
from labkit.launching.modules import FOLLOWS
from tests.launching.stage import visit, write

HERE = Path(__file__).parent
HEAD = (HERE / 'python_head.txt').read_text(encoding='utf-8')
CASES: dict[str, Any] = json.loads((HERE / 'real_launch.json').read_text(encoding='utf-8'))


@pytest.mark.parametrize('name', CASES)
def test_does_as_the_real_one(name: str, tmp_path: Path, toys: Path):
    case = CASES[name]
    files = dict(case['files'])
    main = next(iter(files))
    if main.endswith('.py') and 'LaunchDescription' in files[main]:
        files[main] = HEAD + files[main]
    path = write(tmp_path, files)
    if 'refused' in case:
        with pytest.raises(LabError) as caught:
            visit(path, *case['arguments'])
        # The real one rarely says where; this one always does.
        assert f'{path.parent}/' in str(caught.value), caught.value
        return
    found = visit(path, *case['arguments'])
    seen = json.dumps([found.said, found.started])
    seen = seen.replace(str(tmp_path), 'DIR').replace(str(toys), 'PREFIX')
    assert json.loads(seen) == [case['said'], case['started']]


def test_the_page_names_the_version_and_counts_the_cases():
    page = (HERE.parents[1] / 'docs' / 'launch.md').read_text(encoding='utf-8')
    text = ' '.join(page.split())
    texts = json.loads((HERE / 'real_substitutions.json').read_text(encoding='utf-8'))
    followed = f'the real `launch` {FOLLOWS["launch"]} and `launch_ros` {FOLLOWS["launch_ros"]}'
    assert followed in text
    assert (
        f'{len(CASES) + len(texts)} cases stand in `tests/launching`: {len(CASES)} launch files '
        f'and {len(texts)} texts'
    ) in text
