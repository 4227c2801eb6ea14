"""Answers to `one_topic`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'all topics',
        'every node publishes on some topics besides its own',
        ("'/temperature', ", ''),
    ),
    wrong('not ended', 'A recording goes on until it is ended', ('recording.stop()\n', '')),
    wrong('another topic', 'Another topic was recorded.', ("'/temperature', ", "'/wind', ")),
    wrong(
        'two topics',
        'More than one topic was chosen.',
        (
            "recording = lab.record('bags/temperature', '/temperature', ",
            "NAMES = ['/temperature', '/wind']\n"
            "recording = lab.record('bags/temperature', '/temperature', ",
        ),
        ("'/temperature', storage", 'NAMES, storage'),
        ('recording =', '\nrecording ='),
    ),
    wrong(
        'misspelled, and not waited for',
        'What nobody publishes while it is recorded is not in a bag.',
        ("'/temperature', ", "'/temprature', "),
        ('recording.wait_for(20)\n', ''),
    ),
    wrong(
        'misspelled',
        "None of 20 messages came to 'bags/temperature'",
        ("'/temperature', ", "'/temprature', "),
        ('wait_for(20)', 'wait_for(20, timeout_sec=0.5)'),
        outcome=ERROR,
    ),
    wrong(
        'beside the folder',
        'from the folder of this notebook on',
        ("'bags/temperature'", "'temperature'"),
    ),
    wrong(
        'another name',
        "Write 'bags/temperature', letter by letter.",
        ("'bags/temperature'", "'bags/temperatures'"),
    ),
    wrong(
        'a part of the name',
        'every node publishes on some topics besides its own',
        ("'/temperature', ", "regex='t', "),
    ),
    wrong('the folder is there already', 'overwrite=True', outcome=ERROR),
    wrong('a second station', 'a second node publishes there, too'),
    right('with block'),
    right('count'),
    right('regular expression', ("'/temperature', ", "regex='^/temp', ")),
    right(
        'all but the others',
        # Other notebooks of this domain may have topics, too.
        ("'/temperature', storage", "exclude=['^/(?!temp)'], storage"),
        ('recording = lab.record(', 'recording = lab.record(\n    '),
        ('overwrite=True)', 'overwrite=True\n)'),
    ),
    right('command line'),
]
