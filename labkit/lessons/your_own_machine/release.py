"""Exercise: a version of a package, in git and as an archive."""

from __future__ import annotations

import re
import shutil
import subprocess
import tarfile
import zlib
from collections.abc import Sequence
from hashlib import sha1

from labkit.exercises import Exercise, Fail, NotAttempted, words_of
from labkit.exercises.clauses import Asked
from labkit.exercises.figures import many
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
NOT_PACKED = WORDS.mistake('release/not-packed')
OTHER_FILES = WORDS.mistake('release/other-files')


def _git(work: Work, *words: str) -> str:
    """Return what git says in the workspace; `''` if it fails."""
    done = subprocess.run(
        ['git', *words], cwd=work.folder, capture_output=True, text=True, check=False
    )
    return done.stdout if done.returncode == 0 else ''


def _tagged(work: Work) -> dict[str, str]:
    """Return the names of the files that the tag holds, in their order, with git's hashes."""
    lines = _git(work, 'ls-tree', '-r', VERSION).splitlines()
    pairs = [line.partition('\t')[::2] for line in lines]
    return {name: about.split()[2] for about, name in sorted(pairs, key=lambda pair: pair[1])}


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
    wanted = f'{ARCHIVE} with the {many(len(tagged), "file")} of the tag'
    if not path.is_file():
        raise Fail(wanted, f'no {ARCHIVE}', NO_ARCHIVE)
    try:
        with tarfile.open(path, 'r:gz') as archive:
            members = sorted((one for one in archive if one.isfile()), key=lambda one: one.name)
            held = [_blob(archive, member) for member in members]
    except (tarfile.TarError, EOFError, zlib.error):
        raise Fail(wanted, f'{ARCHIVE} is no tar that gzip has packed', NOT_PACKED) from None
    names = [member.name for member in members]
    # git archive --prefix puts the same folder before each name.
    if len(names) != len(tagged) or not all(map(str.endswith, names, tagged)):
        raise Fail(wanted, many(len(names), 'file'), OTHER_FILES)
    others = [name for name, blob in zip(tagged, held, strict=True) if blob != tagged[name]]
    if others:
        raise Fail(wanted, f'another {others[0]}', OTHER_FILES)


def _blob(archive: tarfile.TarFile, member: tarfile.TarInfo) -> str:
    """Return the name that git gives to the content of a file: a hash of it."""
    file = archive.extractfile(member)
    content = file.read() if file is not None else b''
    begin = b'blob %d\0' % len(content)
    return sha1(begin + content, usedforsecurity=False).hexdigest()


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
        return f'The tag {VERSION} and {ARCHIVE} hold {many(len(_tagged(seen[0])), "file")}.'


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
