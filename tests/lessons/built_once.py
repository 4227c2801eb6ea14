"""`colcon`, for proofs: what differs only in the text of modules is built once.

Dozens of answers are the same package with another module, and a build copies modules as they are.
So a package that was built before is put where colcon would build it, with the modules of now.
Whatever else differs, also in a single letter, is built by the real colcon.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def install(folder: Path) -> None:
    """Make the command `colcon` in an empty folder, which is for the first place of PATH."""
    folder.mkdir()
    command = folder / 'colcon'
    # Without `site`, which would start Python a second time.
    command.write_text(f'#!{sys.executable} -IS\n{Path(__file__).read_text(encoding="utf-8")}')
    command.chmod(0o755)


def main(words: list[str]) -> int:
    """Do what colcon does with these words."""
    name = words[2] if len(words) == 3 and words[:2] == ['build', '--packages-select'] else ''
    source = Path('src') / name
    trees = [Path(tree) / name for tree in ('build', 'install')]
    # The real one builds into what an earlier build has left, and makes the first build's scripts.
    new = Path('install/setup.bash').is_file() and not any(tree.exists() for tree in trees)
    if not (name and source.is_dir() and new):
        return subprocess.run([_real(), *words]).returncode
    modules = {path for path in (source / name).glob('*.py') if path.is_file()}
    digest = hashlib.sha256(os.fsencode(Path.cwd()))
    for path in sorted(source.rglob('*')):
        if path.is_file() and '__pycache__' not in path.parts:
            digest.update(b'\0' + os.fsencode(path) + b'\0')
            digest.update(b'' if path in modules else path.read_bytes())
    kept = HERE / digest.hexdigest()
    if kept.is_dir():
        _take(kept, modules)
        return 0
    done = subprocess.run([_real(), *words], stdout=subprocess.PIPE)
    sys.stdout.buffer.write(done.stdout)
    if done.returncode == 0:
        for tree in (*trees, source):
            shutil.copytree(tree, kept / tree, symlinks=True, ignore=_COMPILED)
        (kept / 'stdout').write_bytes(done.stdout)
    return done.returncode


_COMPILED = shutil.ignore_patterns('__pycache__')


def _real() -> str:
    folders = os.environ.get('PATH', os.defpath).split(os.pathsep)
    others = os.pathsep.join(folder for folder in folders if folder != str(HERE))
    return shutil.which('colcon', path=others) or sys.exit('no colcon on PATH')


def _take(kept: Path, modules: set[Path]) -> None:
    """Put a build that was kept in its place, written now, with the modules of now."""
    for tree in ('build', 'install'):
        shutil.copytree(
            kept / tree, tree, symlinks=True, dirs_exist_ok=True, copy_function=shutil.copy
        )
    for module in modules:
        before, now = (kept / module).read_bytes(), module.read_bytes()
        for tree in ('build', 'install'):
            for path in Path(tree, module.parent.name).rglob('/'.join(module.parts[-2:])):
                if path.read_bytes() == before:
                    path.write_bytes(now)
    # The real one writes this last.
    for path in Path('build').glob('*/colcon_build.rc'):
        if (kept / path).is_file():
            path.touch()
    sys.stdout.buffer.write((kept / 'stdout').read_bytes())


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
