"""Errors that name what to do."""

from __future__ import annotations

import pickle
import re
import shlex
import tomllib
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from igrip.errors import MissingExtraError, install_command, requires_extra


def test_a_missing_extra_is_named_with_how_to_get_it():
    with (
        pytest.raises(MissingExtraError, match=r"the page needs .*websockets.*: pip install "),
        requires_extra("websockets", "viewer", "the page"),
    ):
        import igrip.no_such_module  # noqa: F401
    with (
        pytest.raises(MissingExtraError) as caught,
        requires_extra("pylsl", "outputs", "LSL", errors=(ImportError, RuntimeError)),
    ):
        raise RuntimeError("liblsl is not there")
    assert isinstance(caught.value, ImportError)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_other_errors_and_successful_imports_pass():
    with requires_extra("json", "outputs", "nothing"):
        import json
    assert json.loads("1") == 1
    with pytest.raises(ZeroDivisionError), requires_extra("json", "outputs", "nothing"):
        1 / 0  # noqa: B018


def test_the_remedy_of_a_missing_extra_names_its_packages_as_pyproject_does() -> None:
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]
    for extra, packages in project["optional-dependencies"].items():
        command = shlex.split(install_command(extra))
        assert command[:2] == ["pip", "install"]
        names = {re.split(r"[<>=!\[;]", package)[0].strip() for package in packages}
        assert {re.split(r"[<>=!\[;]", package)[0].strip() for package in command[2:]} == names


def test_a_source_tree_without_metadata_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> list[str]:
        raise PackageNotFoundError(name)

    monkeypatch.setattr("importlib.metadata.requires", missing)
    assert install_command("viewer") == "pip install 'igrip[viewer]'"
