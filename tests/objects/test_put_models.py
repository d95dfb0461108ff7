"""Models that are put into a catalogue at run time, and what uses them."""

import numpy as np
import pytest
import trimesh

import igrip
from igrip.errors import ObjectsError
from igrip.objects.mesh_writer import models_beside, write_models
from igrip.objects.model import build_model

UP = np.array([0.0, 0.0, 1.0])


def thing(height, name="object_1"):
    return build_model(name, trimesh.creation.box((0.05, 0.06, height)), "box")


def message(t, hand=None):
    hands = {} if hand is None else {"right": {"position": hand}}
    pose = {"position": [0.3, 0.0, 0.0], "orientation": [0, 0, 0, 1], "model": "object_1"}
    return igrip.Observation(t=t, hands=hands, objects={"thing": pose})


@pytest.fixture
def catalog():
    return igrip.load_objects("box:0.07x0.16x0.21")


def test_a_model_is_put_replaced_and_listed(catalog):
    catalog.put(thing(0.1))
    assert "object_1" in catalog
    assert len(catalog) == len(list(catalog)) == 2
    refined = thing(0.12)
    catalog.put(refined)
    assert catalog["object_1"] is refined
    assert list(catalog.put_models) == ["object_1"]


def test_a_model_of_a_source_is_not_replaced(catalog):
    (name,) = catalog
    with pytest.raises(ObjectsError, match="already"):
        catalog.put(thing(0.1, name))


def test_a_refined_model_is_used_but_not_while_a_hand_reaches(catalog):
    catalog.put(thing(0.1))
    estimator = igrip.Estimator(catalog)
    for k in range(15):
        estimator.update(message(0.02 * k, [0.0, 0.0, 0.0]))
    assert estimator.objects[0].model.length == pytest.approx(0.1)
    for k in range(15, 30):  # at 0.5 m/s
        (intention,) = estimator.update(message(0.02 * k, [0.01 * (k - 14), 0.0, 0.0]))
        if intention.status == "reaching":
            break
    assert intention.status == "reaching"
    catalog.put(thing(0.2))
    moved = 0.01 * (k - 13)
    estimator.update(message(0.02 * (k + 1), [moved, 0.0, 0.0]))
    assert estimator.objects[0].model.length == pytest.approx(0.1)
    for n in range(2, 60):
        (intention,) = estimator.update(message(0.02 * (k + n), [moved, 0.0, 0.0]))
        before = estimator.objects[0].model.length
        if intention.status != "reaching" and n > 50:
            break
    assert before == pytest.approx(0.2)
    scores = list(intention.scores["thing"].values())
    assert np.isfinite(scores).all()


def test_models_are_written_beside_a_recording_and_read_as_they_are(tmp_path):
    round_one = build_model("my mug", trimesh.creation.cylinder(0.04, 0.05), "cylinder", UP)
    folder = models_beside(tmp_path / "live.jsonl")
    write_models(folder, {"object_1": thing(0.1), "my mug": round_one})
    read = igrip.load_objects(folder)
    assert set(read) == {"object_1", "my mug"}
    assert read["object_1"].length == pytest.approx(0.1, abs=1e-6)
    np.testing.assert_allclose(np.abs(read["my mug"].axis), UP, atol=1e-6)
    assert read["my mug"].symmetry == "cylinder"
    assert read["my mug"].length == pytest.approx(0.05, abs=1e-6)


def test_no_models_no_folder(tmp_path):
    write_models(tmp_path / "x.objects", {})
    assert not (tmp_path / "x.objects").exists()
