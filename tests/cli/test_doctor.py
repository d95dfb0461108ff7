"""What ``igrip doctor`` reads from the installed package."""

import tomllib
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from igrip.cli import doctor

PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]


def test_dependencies_are_those_of_the_package() -> None:
    found = doctor.dependencies()
    assert set(found) == {"", *PROJECT["optional-dependencies"]}
    assert len(found[""]) == len(PROJECT["dependencies"])
    assert found[""]["numpy"]
    assert {"mediapipe", "opencv-python-headless"} == set(found["hands"])


def test_a_bare_source_tree_has_none(monkeypatch: pytest.MonkeyPatch) -> None:
    def requires(package: str) -> list[str]:
        raise PackageNotFoundError(package)

    monkeypatch.setattr(doctor, "requires", requires)
    assert doctor.dependencies() == {"": {}}


def test_what_is_absent_or_broken_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        doctor, "requires", lambda package: ["numpy>=2", "nothing-like-it>=1; extra == 'odd'"]
    )
    assert doctor.dependencies()["odd"] == {"nothing-like-it": None}

    def broken() -> str:
        raise ValueError("no cache")

    assert doctor._result(broken) == {"ok": False, "detail": "ValueError: no cache"}
