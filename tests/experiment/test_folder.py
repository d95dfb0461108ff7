"""The folder of a study: its models are found, and what is missing is named by its key."""

from __future__ import annotations

import shutil

import pytest
import trimesh

from igrip.experiment.folder import StudyFolder
from igrip.experiment.study import StudyError
from small_study import small_study


@pytest.mark.parametrize(("key", "value", "words"), [
    ("models", '["meshes"]', "models: "),
    ("model", '"005_tomato_can"', r"objects\.\w+\.model: .*did you mean '005_tomato_soup_can'"),
])  # fmt: skip
def test_a_missing_model_is_named_with_file_and_key(tmp_path, key, value, words):
    folder = small_study(tmp_path / "study", **{key: value})
    with pytest.raises(StudyError, match=rf"study\.toml: {words}"):
        folder.catalog()
    assert folder.participants() == []


def test_meshes_beside_the_study_file_are_found_from_anywhere(tmp_path, monkeypatch):
    folder = small_study(tmp_path / "study", models='["meshes"]', model='"mug"')
    meshes = folder.path / "meshes"
    meshes.mkdir()
    trimesh.creation.cylinder(0.04, 0.1).export(meshes / "mug.stl")
    monkeypatch.chdir(tmp_path)
    assert list(folder.catalog()) == ["mug"]
    shutil.rmtree(meshes)
    with pytest.raises(StudyError, match="models: "):
        folder.catalog()


def test_a_plan_for_other_places_does_not_go_on(tmp_path):
    folder = small_study(tmp_path / "study")
    folder.enrol("P01", "2026-01-31")
    file = folder.path / "study.toml"
    file.write_text(file.read_text().replace("{A = ", "{near = "))
    with pytest.raises(StudyError, match="drawn for other places"):
        StudyFolder(folder.path).check("P01", None)


def test_a_new_participant_is_checked_without_a_trace(tmp_path):
    folder = small_study(tmp_path / "study")
    assert folder.check("P01", "2026-01-31") is None
    assert folder.participants() == []
    plan = folder.enrol("P01", "2026-01-31")
    assert folder.check("P01", None) == plan
