"""Study files: the templates are the paper's and a small one; what is wrong is named."""

from __future__ import annotations

import itertools
import tomllib
from importlib import resources

import pytest

from igrip import load_objects
from igrip.experiment.folder import new_study
from igrip.experiment.study import (
    SCREEN,
    Study,
    StudyError,
    read_instructions,
    read_study,
    template_text,
)
from igrip.objects.catalog import PAPER_OBJECTS


def test_the_template_is_the_papers():
    study = Study(**tomllib.loads(template_text("paper")))
    assert study.trial_count == 2 * 4 * 2 * 2 * 4 == 128
    assert {one.model for one in study.objects.values()} == set(PAPER_OBJECTS)
    assert (len(study.cameras), study.rate) == (2, 30.0)
    assert set(load_objects(*study.models)) >= {one.model for one in study.objects.values()}
    spots = list(study.layouts.places.values())
    apart = [sum((a - b) ** 2 for a, b in zip(p, q, strict=True)) ** 0.5
             for p, q in itertools.combinations(spots, 2)]  # fmt: skip
    assert min(apart) > 0.17  # as far as the objects of the simulated cohort


@pytest.mark.parametrize(("old", "new", "words"), [
    ("target = [", "tarjet = [", "did you mean 'target'"),
    ("hand = [", "# hand = [", "hand is missing"),
    ('"mustard", "soup"]', '"mustrad", "soup"]', "did you mean 'mustard'"),
    ('hand = ["right"]', 'hand = ["rihgt"]', "did you mean 'right'"),
    ("repetitions = 1", "repetitons = 1", "did you mean 'repetitions'"),
    ("repetitions = 1", "repetitions = 9000", "repetitions"),
    (", D = [0.30, 0.34]", "", "3 places for 4 objects"),
    ('colour = "#f2b705"', 'colour = "yellow"', "colour"),
    ("seed = 1", "seed = ", "is not TOML"),
    ("[objects.soup]", '[objects.left]\nmodel = "soup"\n\n[objects.soup]', "objects.left"),
    ('cameras = ["left", "right"]', "cameras = []", "cameras"),
    ('cameras = ["left", "right"]', 'cameras = ["../up", "right"]', "letters, digits"),
])  # fmt: skip
def test_what_is_wrong_is_named_with_the_file(tmp_path, old, new, words):
    new_study(tmp_path / "s", "small")
    file = tmp_path / "s" / "study.toml"
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))
    with pytest.raises(StudyError) as error:
        read_study(tmp_path / "s")
    assert "study.toml" in str(error.value)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_a_folder_without_a_study_names_the_command(tmp_path):
    with pytest.raises(StudyError, match="igrip experiment new"):
        read_study(tmp_path)
    (tmp_path / "note").write_text("x")
    with pytest.raises(StudyError, match="exists already"):
        new_study(tmp_path, "paper")


@pytest.mark.parametrize("language", ["en", "fr"])
def test_every_level_of_the_paper_has_words(tmp_path, language):
    study = Study(**tomllib.loads(template_text("paper"))).model_copy(update={"language": language})
    words = read_instructions(tmp_path, language)
    assert set(words.screen) == set(SCREEN)
    for levels in study.combinations():
        read = words.words(levels, study)
        assert all(text != levels[factor] or factor == "target" for factor, text in read.items())
        assert read["target"] == study.objects[levels["target"]].names[language]


def test_a_language_of_ones_own(tmp_path):
    with pytest.raises(StudyError, match=r"instructions/de\.toml"):
        read_instructions(tmp_path, "de")
    (tmp_path / "instructions").mkdir()
    packaged = resources.files("igrip.experiment") / "instructions" / "en.toml"
    text = packaged.read_text("utf-8").replace("Left hand", "Left one")
    (tmp_path / "instructions" / "de.toml").write_text(text)
    assert read_instructions(tmp_path, "de").levels["hand"]["left"] == "Left one"
    (tmp_path / "instructions" / "de.toml").write_text('[screen]\ngo = "Los"\n')
    with pytest.raises(StudyError, match="without wait, ready"):
        read_instructions(tmp_path, "de")
