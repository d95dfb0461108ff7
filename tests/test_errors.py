"""Errors that tell what to do."""

from __future__ import annotations

import pickle

import pytest

from igrip.errors import MissingExtraError, requires_extra


def test_a_missing_extra_is_named_with_how_to_get_it():
    with (
        pytest.raises(MissingExtraError, match=r"the page needs .*pip install 'igrip\[viewer\]'"),
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
