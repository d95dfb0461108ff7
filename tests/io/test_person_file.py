"""The file of a person: what is kept, and what is refused."""

from __future__ import annotations

import json

import pytest

from igrip.adaptation import AdaptationConfig
from igrip.io.person_file import FORMAT, PersonFile, PersonFileError


def test_what_is_learned_is_kept(tmp_path):
    path = tmp_path / "anna.json"
    first = PersonFile(path)
    first.keep()
    assert not path.exists()  # there is nothing to keep yet
    first.person.margin, first.person.reaches, first.person.wrong = 0.085, 12, 3
    first.keep()
    assert json.loads(path.read_text()) == {
        "format": FORMAT, "margin": 0.085, "reaches": 12, "wrong": 3,
    }  # fmt: skip
    assert PersonFile(path).person == first.person
    assert [p.name for p in tmp_path.iterdir()] == ["anna.json"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "delete it to start again"),
        ("{}", "delete it to start again"),
        ('{"format": "igrip-person/1", "margin": NaN, "reaches": 1, "wrong": 0}', "start again"),
        ('{"format": "igrip-person/1", "margin": 0, "reaches": 1, "wrong": 0, "x": 1}', "again"),
        ('{"format": "igrip-scorer/2", "margin": 0, "reaches": 1, "wrong": 0}', "its format is"),
        ('{"format": "igrip-person/1", "margin": 0, "reaches": 1, "wrong": 2}', "2 wrong ones"),
    ],
)
def test_other_files_are_refused(tmp_path, text, message):
    path = tmp_path / "anna.json"
    path.write_text(text)
    with pytest.raises(PersonFileError, match=message):
        PersonFile(path)
    assert path.read_text() == text


def test_a_margin_beyond_the_bounds_is_brought_back(tmp_path):
    """Nobody can write a file by hand that makes a hand close at any probability."""
    path = tmp_path / "anna.json"
    path.write_text(f'{{"format": "{FORMAT}", "margin": -5, "reaches": 9, "wrong": 0}}')
    assert PersonFile(path).person.margin == -AdaptationConfig().max_fall


def test_a_folder_that_is_not_there(tmp_path):
    file = PersonFile(tmp_path / "nowhere" / "anna.json")
    file.person.reaches = 1
    with pytest.raises(PersonFileError, match="No such file"):
        file.keep()
