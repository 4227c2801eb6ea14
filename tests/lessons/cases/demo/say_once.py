"""Answers to `say_once`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'twice',
        'more than once',
        (
            "pub.publish(String(data='late'))\n",
            "pub.publish(String(data='late'))\npub.publish(String(data='late'))\n",
        ),
    ),
    wrong('other text', 'Another text was published', ("'late'", "'Late'")),
    wrong('never', 'no loop publishes', ("pub.publish(String(data='late'))\n", '')),
    right(
        'node gone again',
        (
            "pub.publish(String(data='late'))\n",
            "pub.publish(String(data='late'))\nnode.destroy_node()\n",
        ),
    ),
]
