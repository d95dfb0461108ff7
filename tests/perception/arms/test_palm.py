"""The palm of arms that the network did not learn from, and files that are no network."""

import json

import numpy as np
import pytest

from igrip.errors import IgripError
from igrip.perception.arms.palm import FILE, TO_SKIN, arm_end, palm_model, read_palm
from training.palm import SEEDS
from training.worn_hands import KINDS, arm_views


def test_the_palm_of_arms_that_were_not_learned_from():
    off, stated = [], []
    new = [arm for number in range(2 * len(KINDS)) for arm in arm_views(number, SEEDS[0] + 1000)]
    for arm in new:
        end = arm_end(arm.points, arm.entry, arm.camera)
        to_camera = (arm.camera - arm.palm) / np.linalg.norm(arm.camera - arm.palm)
        off.append(np.linalg.norm(end.palm - TO_SKIN * to_camera - arm.palm))
        stated.append(end.std)
        assert np.linalg.norm(end.along) == pytest.approx(1.0)
    assert len(off) > 40
    assert np.median(off) < 0.018
    assert np.mean(np.array(off) < 0.025) > 0.75
    # the std that is stated is that of an axis
    assert np.sqrt(np.mean(np.square(off)) / 3.0) < 1.25 * np.mean(stated)


def test_a_few_points_show_no_palm():
    assert arm_end(np.zeros((10, 3)), np.ones(3), np.array([0.0, 0.0, 1.0])) is None


def test_strange_inputs_are_not_extrapolated_to():
    model = palm_model()
    far = model.palm(model.mean + 1e6 * model.scale)
    assert far == pytest.approx(model.palm(model.mean + 10.0 * model.scale))
    assert np.linalg.norm(far) < 0.5


@pytest.mark.parametrize(
    ("name", "value"),
    [("mean", [0.0]), ("hidden", [[1.0, 2.0]]), ("out_bias", [0.0, 0.0]), ("std", [None])],
)
def test_a_damaged_file_is_refused(tmp_path, name, value):
    content = json.loads(FILE.read_text())
    (tmp_path / "palm.json").write_text(json.dumps(content | {name: value}))
    with pytest.raises(IgripError, match=name):
        read_palm(tmp_path / "palm.json")
