"""Answers to `release`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

BOTH = "('package.xml', 'setup.py')"
INIT = '!git init -q -b main\n'
ADD = '!git add .gitignore src/courier_lab\n'
COMMIT = "!git commit -q -m 'Release the courier'\n"
TAG = '!git tag 1.0.0\n'
ARCHIVE = '!git archive --prefix=ros2_ws/ -o courier.tar.gz 1.0.0\n'
WRITTEN = "!echo '# later' >> src/courier_lab/setup.py\n"

ANSWERS = [
    wrong(
        'package.xml alone', '1.0.0 in package.xml, 0.0.0 in setup.py', (BOTH, "['package.xml']")
    ),
    wrong('setup.py alone', '0.0.0 in package.xml, 1.0.0 in setup.py', (BOTH, "['setup.py']")),
    wrong('no tag', 'Seen: no tag', (TAG, ''), (ARCHIVE, ARCHIVE.replace('1.0.0', 'HEAD'))),
    wrong(
        'another tag',
        'Seen: tags: v1.0.0',
        (TAG, TAG.replace('1.0.0', 'v1.0.0')),
        (ARCHIVE, ARCHIVE.replace('1.0.0', 'v1.0.0')),
    ),
    wrong(
        'a repository in src',
        'a repository in src/courier_lab',
        (INIT, ''),
        ("!printf 'build", "%cd -q src/courier_lab\n!git init -q -b main\n!printf 'build"),
        (ADD, '!git add .\n'),
        ('!git config user.name Ada\n!git config user.email ada@example.org\n', ''),
        (
            COMMIT,
            "!git -c user.name=Ada -c user.email=ada@example.org commit -q -m 'Release it'\n",
        ),
        (ARCHIVE, '!git archive -o ../../courier.tar.gz 1.0.0\n%cd -q ../..\n'),
    ),
    wrong(
        'the resource file is missing',
        'Seen: without src/courier_lab/resource/courier_lab',
        (ADD, ADD + '!git rm -q --cached src/courier_lab/resource/courier_lab\n'),
    ),
    wrong(
        'a file is missing',
        'Seen: without src/courier_lab/',
        (ADD, ADD.replace('src/courier_lab', 'src/courier_lab/package.xml src/courier_lab/c*')),
    ),
    wrong(
        'changed after the commit',
        'A tag stays at its commit',
        (TAG, TAG + WRITTEN),
    ),
    wrong(
        'with the log of colcon',
        'colcon makes these folders anew on each machine',
        (ADD, '!mkdir -p log && touch log/now\n' + ADD + '!git add -f log\n'),
    ),
    wrong('no archive', 'Seen: no courier.tar.gz', (ARCHIVE, '')),
    wrong(
        'an archive of the folder',
        'It was made of another commit, or of the folder itself.',
        (ARCHIVE, '!tar -czf courier.tar.gz src/courier_lab .git .gitignore\n'),
    ),
    wrong(
        'an archive that is none',
        'courier.tar.gz is no tar that gzip has packed',
        (ARCHIVE, '!echo 1.0.0 > courier.tar.gz\n'),
    ),
    wrong(
        'an archive of the version before',
        'Seen: another src/courier_lab/package.xml',
        (
            ADD,
            ADD
            + "!sed -i 's/1.0.0/0.0.0/' src/courier_lab/package.xml\n"
            + ADD
            + "!git commit -q -m 'Add the courier'\n"
            + '!git tag before\n'
            + "!sed -i 's/0.0.0/1.0.0/' src/courier_lab/package.xml\n"
            + ADD,
        ),
        (ARCHIVE, ARCHIVE.replace(' 1.0.0\n', ' before\n')),
    ),
    wrong(
        'an archive of another text',
        'Seen: another src/courier_lab/courier_lab/courier.py',
        (
            ARCHIVE,
            '!git clone -q . ../packed\n'
            "!echo '# more' >> ../packed/src/courier_lab/courier_lab/courier.py\n"
            '!tar -czf courier.tar.gz --exclude=.git -C ../packed .\n'
            '!rm -rf ../packed\n',
        ),
    ),
    wrong(
        'an archive beside the workspace',
        'Seen: no courier.tar.gz',
        ('-o courier.tar.gz', '-o src/courier.tar.gz'),
    ),
    wrong(
        'a tar that is not packed',
        'promises a file that gzip has packed',
        (' -o courier.tar.gz', ' --format=tar -o courier.tar.gz'),
    ),
    wrong(
        'half of an archive',
        'courier.tar.gz is no tar that gzip has packed',
        (ARCHIVE, ARCHIVE + '!truncate -s 500 courier.tar.gz\n'),
    ),
    right('no folder before the names', (' --prefix=ros2_ws/', '')),
    right(
        'all of src, and a note',
        (ADD, '!git add .gitignore src\n'),
        (TAG, "!git tag -a 1.0.0 -m 'The first one'\n"),
    ),
    right(
        'after an earlier commit',
        (
            ADD,
            ADD + "!git commit -q --allow-empty -m 'Begin'\n" + '!git tag 0.0.0\n' + WRITTEN + ADD,
        ),
    ),
    right(
        'packed by tar',
        (
            ARCHIVE,
            '!git clone -q . ../packed\n'
            '!tar -czf courier.tar.gz --exclude=.git -C ../packed .\n'
            '!rm -rf ../packed\n',
        ),
    ),
    right(
        'the tag once more',
        (TAG, TAG + WRITTEN + "!git commit -q -a -m 'Mend'\n!git tag -f 1.0.0\n"),
    ),
]
