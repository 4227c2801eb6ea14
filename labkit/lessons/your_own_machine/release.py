"""Exercise: a version of a package, in git and as an archive."""

from __future__ import annotations

import re
import shutil
import subprocess
import tarfile
from collections.abc import Sequence

from labkit.exercises import Exercise, Fail, NotAttempted, words_of
from labkit.exercises.clauses import Asked
from labkit.lessons.package.content import InAWorkspace, Work, own_files
from labkit.lessons.your_own_machine.made import COURIER

__all__ = ['exercise']

WORDS = words_of(__file__)

VERSION, ARCHIVE, MADE = '1.0.0', 'courier.tar.gz', ('build', 'install', 'log')

TWO_VERSIONS = WORDS.mistake('release/two-versions')
ELSEWHERE = WORDS.mistake('release/elsewhere')
NO_TAG = WORDS.mistake('release/no-tag')
NOT_ADDED = WORDS.mistake('release/not-added')
LATER = WORDS.mistake('release/later')
MADE_BY_COLCON = WORDS.mistake('release/made-by-colcon')
NO_ARCHIVE = WORDS.mistake('release/no-archive')
OTHER_FILES = WORDS.mistake('release/other-files')


def _git(work: Work, *words: str) -> str:
    """Return what git says in the workspace; `''` if it fails."""
    done = subprocess.run(
        ['git', *words], cwd=work.folder, capture_output=True, text=True, check=False
    )
    return done.stdout if done.returncode == 0 else ''


def _tagged(work: Work) -> list[str]:
    """Return the names of the files that the tag holds."""
    return sorted(_git(work, 'ls-tree', '-r', '--name-only', VERSION).splitlines())


def _versions(work: Work) -> tuple[str, str]:
    """Return what package.xml and setup.py say."""
    patterns = {
        'package.xml': r'<version>([^<]*)',
        'setup.py': r"""\bversion\s*=\s*['"]([^'"]*)""",
    }
    said = []
    for name, pattern in patterns.items():
        path = work.source / name
        found = path.is_file() and re.search(pattern, path.read_text('utf-8', errors='replace'))
        said.append(found[1].strip() if found else 'none')
    return said[0], said[1]


def _says_version(work: Work) -> None:
    xml, setup = _versions(work)
    if (xml, setup) != (VERSION, VERSION):
        seen = f'{xml} in package.xml, {setup} in setup.py'
        raise Fail(f'version {VERSION} in both files', seen, TWO_VERSIONS)


def _has_files(work: Work) -> None:
    wanted = f'the files of src/{COURIER}, as they are now, under the tag {VERSION}'
    if not (work.folder / '.git').exists():
        found = sorted(work.folder.glob('src/**/.git'))
        seen = f'a repository in {found[0].parent.relative_to(work.folder)}' if found else 'none'
        raise Fail('a git repository in the workspace', seen, ELSEWHERE)
    tags = _git(work, 'tag').split()
    if VERSION not in tags:
        raise Fail(wanted, f'tags: {", ".join(tags)}' if tags else 'no tag', NO_TAG)
    tagged, folder = _tagged(work), f'src/{COURIER}'
    names = sorted(str(path.relative_to(work.folder)) for path in own_files(work.source))
    lost = [name for name in names if name not in tagged]
    if lost:
        raise Fail(wanted, f'without {lost[0]}', NOT_ADDED)
    changed = _git(work, 'diff', '--name-only', VERSION, '--', folder).split()
    if changed:
        raise Fail(wanted, f'{changed[0]} is another one now', LATER)


def _has_sources_alone(work: Work) -> None:
    made = [name for name in _tagged(work) if name.partition('/')[0] in MADE]
    if made:
        raise Fail(f'no file of {", ".join(MADE)}', made[0], MADE_BY_COLCON)


def _is_archived(work: Work) -> None:
    path, tagged = work.folder / ARCHIVE, _tagged(work)
    wanted = f'{ARCHIVE} with the {len(tagged)} files of the tag'
    if not path.is_file():
        raise Fail(wanted, f'no {ARCHIVE}', NO_ARCHIVE)
    try:
        with tarfile.open(path) as archive:
            files = sorted(member.name for member in archive if member.isfile())
            package = next((name for name in files if name.endswith('/package.xml')), '')
            held = archive.extractfile(package) if package else None
            text = held.read().decode() if held else ''
    except tarfile.TarError:
        raise Fail(wanted, f'{ARCHIVE} is not such an archive', OTHER_FILES) from None
    # git archive --prefix puts the same folder before each name.
    same = len(files) == len(tagged) and all(map(str.endswith, files, tagged))
    if not same or f'<version>{VERSION}<' not in text:
        seen = f'{len(files)} files' if not same else 'files of another version'
        raise Fail(wanted, seen, OTHER_FILES)


def _is_untouched(work: Work) -> bool:
    if shutil.which('git') is None:
        raise NotAttempted('git is not installed here, so do this on the other machine.')
    if not (work.source / 'package.xml').is_file():
        return True
    return VERSION not in _versions(work) and not (work.folder / ARCHIVE).exists()


class InARepository(InAWorkspace):
    """A package whose workspace is a git repository."""

    def tell(self, seen: Sequence[Work]) -> str:
        """Say what the tag holds."""
        return f'The tag {VERSION} and {ARCHIVE} hold {len(_tagged(seen[0]))} files.'


exercise = Exercise(
    words=WORDS,
    clauses=(
        Asked(WORDS.of(version=VERSION).clause('says-version'), _says_version),
        Asked(
            WORDS.of(version=VERSION).clause('has-files'),
            _has_files,
        ),
        Asked(WORDS.clause('has-sources-alone'), _has_sources_alone),
        Asked(WORDS.clause('is-archived'), _is_archived),
    ),
    stage=InARepository(COURIER, _is_untouched),
)
