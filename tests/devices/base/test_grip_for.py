"""Which grip a device does instead of one that it cannot."""

from __future__ import annotations

import pytest

from igrip.devices.base.settings import DeviceFileError, Posture, PostureSettings, read_settings

FLAT = Posture(reach=(0.0,), grasp=(1.0,))


def settings(*grips, **more):
    return PostureSettings(rest=(0.0,), grips=dict.fromkeys(grips, FLAT), **more)


def test_the_taxonomys_nearest():
    device = settings("palmar", "pinch")
    assert device.grip_for("hook") == "palmar"
    assert device.grip_for("tripod") == "pinch"
    assert settings("palmar", "pinch", "tripod").grip_for("tripod") == "tripod"


def test_the_papers_grips_are_done_or_refused_as_before():
    assert settings("palmar").grip_for("pinch") is None
    assert settings("pinch").grip_for("palmar") is None
    assert settings("palmar").grip_for("palmar") == "palmar"
    assert settings("palmar").grip_for("my own") is None


def test_a_declared_order_holds(tmp_path):
    path = tmp_path / "hand.toml"
    text = """
    rest = [0.0]
    [grips.palmar]
    reach = [0.0]
    grasp = [1.0]
    [instead]
    pinch = ["palmar"]
    tripod = []
    """
    path.write_text(text)
    device = read_settings(PostureSettings, path)
    assert device.grip_for("pinch") == "palmar"
    assert device.grip_for("tripod") is None
    path.write_text(text.replace("tripod", "claw"))
    with pytest.raises(DeviceFileError, match="no grip 'claw'"):
        read_settings(PostureSettings, path)
