"""Sources are found by the ending or the scheme of a name."""

from __future__ import annotations

import pytest

import igrip
from igrip.errors import RecordingError, UnknownNameError
from igrip.io.sources import SOURCES


@pytest.mark.parametrize("name", ["reach.txt", "reach", "ws://host:1", "oak:", "", ".", "jsonl"])
def test_unknown_endings_and_schemes(name):
    with pytest.raises(UnknownNameError) as raised:
        igrip.open_source(name)
    assert raised.value.family == "source"
    assert ".jsonl" in raised.value.choices
    assert ".jsonl" in str(raised.value)


def test_a_recording_that_is_not_there(tmp_path):
    with pytest.raises(RecordingError, match=r"nothing\.jsonl"):
        igrip.open_source(tmp_path / "nothing.jsonl")


def test_a_scheme_gets_the_whole_name(monkeypatch):
    SOURCES.names()
    opened = []
    monkeypatch.setitem(SOURCES._members, "toy", lambda name: opened.append(name) or [1, 2])
    assert igrip.open_source("toy:left/a.jsonl") == [1, 2]
    assert opened == ["toy:left/a.jsonl"]


def test_a_file_with_a_colon_in_its_name(tmp_path):
    path = tmp_path / "12:30.jsonl"
    path.write_bytes(b'{"t":1.0}\n')
    assert [observation.t for observation in igrip.open_source(path)] == [1.0]
