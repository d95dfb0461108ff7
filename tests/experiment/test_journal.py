"""The journal: on the disk before it counts, torn lines cut off, damage named."""

from __future__ import annotations

import errno
import json
import os

import pytest

from igrip.experiment.journal import Journal, read_events
from igrip.experiment.study import StudyError


def test_events_are_there_again(tmp_path):
    path = tmp_path / "journal.jsonl"
    journal = Journal(path, lambda: "noon")
    journal.add("trial_started", trial=1)
    journal.add("commented", text="“ça va”\nzwei")
    journal.close()
    assert read_events(path) == [
        {"event": "trial_started", "at": "noon", "trial": 1},
        {"event": "commented", "at": "noon", "text": "“ça va”\nzwei"},
    ]


def test_a_line_cut_at_any_byte_costs_only_itself(tmp_path):
    path = tmp_path / "journal.jsonl"
    journal = Journal(path)
    journal.add("one")
    size = path.stat().st_size
    journal.add("two", text="long enough")
    journal.close()
    data = path.read_bytes()
    for cut in range(size, len(data)):
        path.write_bytes(data[:cut])
        again = Journal(path)
        assert [e["event"] for e in again.events] == ["one"]
        assert again.torn == cut - size
        again.add("three")
        again.close()
        assert [json.loads(line)["event"] for line in path.read_bytes().splitlines()] == [
            "one", "three",
        ]  # fmt: skip


def test_damage_before_the_end_is_named(tmp_path):
    path = tmp_path / "journal.jsonl"
    path.write_bytes(b'{"event": "one", "at": ""}\nrubbish\n{"event": "two", "at": ""}\n')
    with pytest.raises(StudyError, match="line 2"):
        Journal(path)


def test_on_a_full_disk_the_event_has_not_happened(tmp_path, monkeypatch):
    journal = Journal(tmp_path / "journal.jsonl")
    journal.add("one")

    def full(descriptor):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        journal.add("two")
    monkeypatch.undo()
    journal.add("three")
    journal.close()
    assert [e["event"] for e in read_events(tmp_path / "journal.jsonl")] == ["one", "three"]
