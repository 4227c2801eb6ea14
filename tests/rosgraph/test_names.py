"""Names of topics, and why some are none."""

from __future__ import annotations

import pytest

from labkit.background.runtime import runtime
from labkit.errors import LabError
from labkit.rosgraph.names import full_topic_name


@pytest.mark.parametrize('name', ['/a\udcff', b'/a', None])
def test_a_name_that_is_no_text_is_told_in_words(name: object) -> None:
    runtime.start()
    assert runtime.helper is not None
    with pytest.raises(LabError, match='is no name of a topic: it is no text in UTF-8') as caught:
        full_topic_name(name, runtime.helper)  # type: ignore[arg-type]
    assert '::' not in str(caught.value) and '()' not in str(caught.value)
