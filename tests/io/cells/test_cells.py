"""Single cells, dialects and lines."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.errors import DatasetError
from igrip.io.cells.dialect import find_dialect
from igrip.io.cells.lines import Lines, read_lines
from igrip.io.cells.values import clock_time, date_time, known_text, number


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_numbers_are_read_to_the_bit(value):
    assert number(repr(value)) == value
    assert number(f" {value!r}".replace(".", ","), ",") == value


@pytest.mark.parametrize("text", ["1_000", "0x10", "12 mm", "1.2.3", "--1", "one", "1,5"])
def test_what_is_no_number(text):
    assert number(text) is None


@pytest.mark.parametrize("text", ["", " ", "NA", "n/a", "NaN", "None", "null", "-", "inf", "1e999"])
def test_what_is_missing(text):
    assert math.isnan(number(text))


@pytest.mark.parametrize("text", ["lost", "-1", "-1.0"])
def test_words_for_missing_numbers(text):
    assert math.isnan(number(text, missing=["lost", "-1"]))
    assert number("1", missing=["lost", "-1"]) == 1.0


@pytest.mark.parametrize(
    ("text", "seconds"),
    [("00:00:01.5", 1.5), ("23:59:59,25", 86399.25), ("01:02", 62.0), ("12:00:01 AM", 1.0),
     ("1:00:00 PM", 46800.0), ("28.02.2024 10:00:00,5", 36000.5), ("2/28/24 10:00:00", 36000.0)],
)  # fmt: skip
def test_times_of_day(text, seconds):
    assert clock_time(text) == seconds


@pytest.mark.parametrize("text", ["2024-01-01T10:00:00", "2024-01-01 10:00:00.25+02:00"])
def test_dates(text):
    assert date_time(text).hour == 10


@pytest.mark.parametrize("text", ["", "10", "1.5", "P01", "12:", "a:b:c", "2024"])
def test_what_is_no_time(text):
    assert clock_time(text) is None
    assert date_time(text) is None


@pytest.mark.parametrize(("text", "known"), [("NA", "NA"), (" x ", "x"), ("n/a", None), ("", None)])
def test_texts(text, known):
    assert known_text(text) == known


@pytest.mark.parametrize(
    ("lines", "separator", "decimal"),
    [
        (["a,b", "1.5,2"], ",", "."),
        (["a;b", "1,5;2"], ";", ","),
        (["a\tb", "1,5\t2,25"], "\t", ","),
        (["who,what", "Ann; Bob,cup"], ",", "."),
        (["who;what", "Ann;cup, red"], ";", "."),
        (["1 2 3", "4 5 6"], " ", "."),
        (["a,b", '"1,5","2,5"'], ",", ","),
        (["sep=;", "a;b", "1;2"], ";", "."),
        (["one column", "1.5", "2.5"], ",", "."),
    ],
)
def test_dialects(lines, separator, decimal):
    assert find_dialect(lines) == (separator, decimal)


@given(st.lists(st.text(st.characters(codec="utf-8", exclude_characters="\n"), max_size=20)))
def test_lines(texts):
    lines = Lines("".join(f"{text}\n" for text in texts))
    assert [lines[k] for k in range(len(lines))] == texts
    assert list(lines.between(1, 99)) == list(enumerate(texts))[1:]


def test_what_is_no_text(tmp_path):
    path = tmp_path / "t.csv"
    path.write_bytes(bytes(range(256)) * 20 + b"\0" * 500)
    with pytest.raises(DatasetError, match=r"t\.csv: is no text"):
        read_lines(path)
    with pytest.raises(DatasetError, match=r"none\.csv"):
        read_lines(tmp_path / "none.csv")
