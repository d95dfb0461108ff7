"""The rendered camera before a thing that is turned."""

import itertools

import numpy as np
import pytest

from igrip.perception.cameras import CameraError, open_camera
from igrip.perception.cameras._turned_thing import BUSY, STILL, TurnedThing


def test_a_hand_comes_between_still_moments(ycb):
    film = TurnedThing(ycb["025_mug"], step=90.0).film(5.0)
    frames = list(itertools.islice(film, STILL + 2))
    times = [frame.t for frame in frames]
    assert times[0] == 5.0
    np.testing.assert_allclose(np.diff(times), 0.1)
    near = [((frame.depth > 0.0) & (frame.depth < 0.48)).sum() for frame in frames]
    assert 1.3 * max(near[:STILL]) < min(near[STILL:])  # the hand is nearer than the thing
    assert BUSY >= 2


def test_the_thing_is_turned_more_than_once_round(ycb):
    poses = TurnedThing(ycb["025_mug"], step=30.0).poses
    yaws = np.unwrap([np.arctan2(pose[1, 0], pose[0, 0]) for pose in poses])
    assert np.degrees(yaws[-1] - yaws[0]) > 360.0
    assert 20.0 < np.degrees(np.diff(yaws)).min() < np.degrees(np.diff(yaws)).max() < 40.0


def test_it_is_opened_by_its_name_and_closed():
    camera = open_camera("rendered:3?turn=006_mustard_bottle&step=45")
    frame = next(iter(camera))
    assert frame.camera == "rendered"
    assert frame.depth is not None
    camera.close()
    assert list(camera) == []


@pytest.mark.parametrize(
    ("name", "words"),
    [("rendered?turn=mugg", "no model 'mugg'"), ("rendered?turn=025_mug&step=2", "5 to 90"),
     ("rendered?spin=1", "no option is named 'spin'")],
)  # fmt: skip
def test_what_cannot_be_turned_is_explained(name, words):
    with pytest.raises(CameraError, match=words):
        open_camera(name)
