"""Build the documentation site: every lesson with its stored outputs, and all pages of docs/.

Sphinx does the work, with myst-nb for notebooks and Markdown. It reads a copy, since pages link to
sources, which become files of the site, and the front page is README.md.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from labkit.course.run_tests import REQUIREMENTS
from labkit.errors import LabError
from labkit.files import replaced
from labkit.setup.environment import ROOT, environment_variables, make_environment

__all__ = ['build_site']

# What the pages are, or link to.
_SOURCES = ('.ci', '.github', 'docs', 'labkit', 'notebooks', 'tests')
_FILES = ('*.md', '*.txt', 'LICENSE', '.pre-commit-config.yaml')
_LEFT_OUT = shutil.ignore_patterns('__pycache__', '*.pyc', '.ipynb_checkpoints', 'bags')


def build_site(folder: Path) -> str:
    """Build the site, without a network but for what has to be installed first.

    Args:
        folder: Where it is put. What an earlier build has left there is replaced.

    Returns:
        A sentence about the result.

    Raises:
        LabError: Something is wrong in a page, such as a link that leads nowhere; or the folder
            holds something else, or is a link.
    """
    if folder.is_symlink():
        raise LabError(
            f'{folder} is a link, and what it leads to is not replaced.',
            todo=f'Name the folder itself: {folder.resolve()}',
        )
    if folder.is_dir() and any(folder.iterdir()) and not (folder / '.buildinfo').is_file():
        raise LabError(f'{folder} holds something else than a site.', todo='Name another folder.')
    python = make_environment(REQUIREMENTS)
    with tempfile.TemporaryDirectory(prefix='labkit-site-') as place:
        copy = Path(place) / 'copy'
        for name in _SOURCES:
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, copy / name, ignore=_LEFT_OUT)
        for path in (path for name in _FILES for path in ROOT.glob(name)):
            shutil.copy(path, copy)
        shutil.move(copy / 'docs' / 'site' / 'index.md', copy)
        # A badge is a page beside the one that shows the repository, which the site is not. Of a
        # picture in two themes it has the light one.
        readme = copy / 'README.md'
        text = re.sub(r'(?m)^(\[!\[|</?picture>|<source ).*\n', '', readme.read_text('utf-8'))
        readme.write_text(text, 'utf-8')
        new = Path(place) / 'site'
        command = [str(python), '-m', 'sphinx', '-q', '-W', '--keep-going']
        command += ['-c', str(copy / 'docs' / 'site'), str(copy), str(new)]
        done = subprocess.run(
            command, env=environment_variables(), stderr=subprocess.PIPE, text=True, check=False
        )
        if done.returncode != 0:
            words = done.stderr.replace(f'{copy}/', '').strip()
            raise LabError(f'The site was not built:\n{words}', todo='Mend these pages.')
        folder.parent.mkdir(parents=True, exist_ok=True)
        with replaced(folder):
            shutil.move(new, folder)
    return f'{folder / "index.html"} is the front page of the site.'
