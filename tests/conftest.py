"""Shared fixtures, and the profiles of Hypothesis."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, settings

import igrip
from datasets import shared_folder, write_small_dataset
from support import BOX, CAN

COMMON = {
    "deadline": None,
    "derandomize": True,
    "suppress_health_check": [HealthCheck.too_slow],
}
settings.register_profile("default", max_examples=30, **COMMON)
settings.register_profile("thorough", max_examples=500, **COMMON)
settings.load_profile("default")


@pytest.fixture(scope="session")
def ycb():
    """The catalogue of YCB objects."""
    return igrip.load_objects("ycb")


@pytest.fixture(scope="session")
def shapes():
    """A catalogue of a box and a can."""
    return igrip.load_objects(BOX, CAN)


@pytest.fixture
def small_dataset(tmp_path):
    """A dataset of two noise-free reaches, to a near and to a far cylinder."""
    return write_small_dataset(tmp_path / "small")


@pytest.fixture(scope="session")
def shared_data():
    """The folder of real data; the test is skipped where it is absent."""
    folder = shared_folder()
    if folder is None:
        pytest.skip("real data are absent: put them beside the checkout or set IGRIP_SHARED_DATA")
    return folder
