"""The text layer, against Python's own codecs."""

from __future__ import annotations

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.io.text import TextError, decode_text, read_lines, read_text

ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32")
ASCII = st.text(st.characters(min_codepoint=0x21, max_codepoint=0x7E), min_size=8, max_size=30)


@given(st.lists(ASCII, min_size=1), st.sampled_from(ENCODINGS), st.sampled_from(["\n", "\r\n"]))
def test_lines_are_those_that_were_written(lines, encoding, end):
    data = end.join(lines).encode(encoding)
    read = list(read_lines(io.BytesIO(data)))
    assert [line.data.decode() for line in read] == lines
    assert [line.ended for line in read] == [True] * (len(lines) - 1) + [False]
    assert decode_text(data) == "\n".join(lines)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_character_with_the_byte_of_a_line_end_ends_no_line(encoding):
    text = "first line, in plain letters ਊ\u0a00 end\nsecond ਊ"
    read = list(read_lines(io.BytesIO(text.encode(encoding))))
    assert [line.data.decode() for line in read] == text.split("\n")


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_blank_lines_are_counted_and_a_line_that_is_too_long_costs_itself(encoding):
    text = "first\n\n  \n" + 1000 * "x" + "\nlast\n"
    read = list(read_lines(io.BytesIO(text.encode(encoding)), max_length=64))
    assert [line.number for line in read] == [1, 4, 5]
    assert [line.too_long for line in read] == [False, True, False]
    assert read[2].data == b"last"
    assert len(read[1].data) <= 64


@given(st.binary(max_size=300))
def test_any_bytes_give_lines_and_nothing_else(data):
    for line in read_lines(io.BytesIO(data), max_length=20):
        assert len(line.data) <= 80


def test_what_is_no_text_is_named(tmp_path):
    path = tmp_path / "map.toml"
    path.write_bytes(b'name = "th\xe9"\r\n')
    with pytest.raises(TextError, match=r"map\.toml, byte 10"):
        read_text(path)
    assert read_text(path, fallback="cp1252") == 'name = "thé"\n'
