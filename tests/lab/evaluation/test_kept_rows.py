"""Rows in a file: what is kept, what is dropped, and that memory does not hold them."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.errors import RecordingError
from igrip.lab.evaluation.kept_rows import KeptRows

HEADER = b'{"evaluation": "one"}\n'


def rows_of(number):
    return [{"row": number, "text": "ü" * number}, {"row": number, "text": "b"}]


def opened(path, header=HEADER, is_good=lambda number, rows: len(rows) == 2):
    kept = KeptRows(path, header)
    kept.resume(is_good)
    return kept


@given(order=st.permutations(range(6)), cut=st.integers(0, 400))
def test_a_file_that_is_cut_anywhere_keeps_the_whole_trials(tmp_path_factory, order, cut):
    path = tmp_path_factory.mktemp("kept") / "rows.jsonl"
    kept = opened(path)
    for number in order:
        kept.add(number, rows_of(number))
    whole = path.read_bytes()
    assert list(kept.read(order)) == [row for number in order for row in rows_of(number)]
    path.write_bytes(whole[:cut])
    lines = whole[:cut].splitlines(keepends=True)
    again = opened(path)
    for place, number in enumerate(order):
        complete = len(lines) > 2 * place + 2 and lines[2 * place + 2] == (
            json.dumps(rows_of(number)[1]).encode() + b"\n"
        )
        if complete:
            assert number in again
            assert list(again.read([number])) == rows_of(number)
    for number in order:
        if number not in again:
            again.add(number, rows_of(number))
    assert list(again.read(range(6))) == [row for number in range(6) for row in rows_of(number)]


def test_another_evaluation_begins_anew(tmp_path):
    path = tmp_path / "out" / "rows.jsonl"
    opened(path).add(0, rows_of(0))
    assert 0 in opened(path)
    assert 0 not in opened(path, b'{"evaluation": "two"}\n')
    assert path.read_bytes() == b'{"evaluation": "two"}\n'


@pytest.mark.parametrize("line", [b"[]\n", b"5\n", b"\xff\n", b'{"row": "x"}\n', b"{}\n"])
def test_a_foreign_line_is_no_row(tmp_path, line):
    path = tmp_path / "rows.jsonl"
    path.write_bytes(HEADER + line + json.dumps(rows_of(1)[1]).encode() + b"\n")
    assert 1 not in opened(path)


def test_a_file_that_cannot_be_written_is_named(tmp_path):
    kept = opened(tmp_path / "rows.jsonl")
    (tmp_path / "rows.jsonl").unlink()
    (tmp_path / "rows.jsonl").mkdir()
    with pytest.raises(RecordingError, match=r"rows\.jsonl: Is a directory"):
        kept.add(0, rows_of(0))
