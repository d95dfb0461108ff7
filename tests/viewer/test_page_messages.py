"""What the page gets equals what was decided, and a mesh arrives as it is."""

from __future__ import annotations

import json

import msgspec
import numpy as np
import pytest

from igrip import Intention, load_objects
from igrip.intention import Commitment
from igrip.viewer.page_messages import encode_mesh, row_of, row_of_hand, scene_of
from igrip.viewer.snapshot import rays_of
from moments import demo_moments


@pytest.fixture(scope="module")
def moments():
    return demo_moments(load_objects("ycb"))


def test_a_row_has_every_number_of_its_intention(moments):
    seen = 0
    for moment in moments:
        for hand in moment.hands:
            row, said = row_of_hand(hand), hand.intention
            assert (row["t"], row["hand"], row["status"]) == (
                pytest.approx(said.t, abs=1e-5), said.hand, said.status,
            )  # fmt: skip
            assert row.get("target") == said.target
            assert row.get("grip") == said.grip
            assert row.get("contact_in") == (
                said.time_to_contact and pytest.approx(said.time_to_contact, abs=1e-5)
            )
            assert row.get("p") == (said.probability and pytest.approx(said.probability, abs=1e-5))
            for id, scores in said.scores.items():
                assert row["scores"][id] == pytest.approx(scores, abs=1e-5)
                seen += len(scores)
            assert row.get("speed") == (hand.motion and pytest.approx(hand.motion.speed, abs=1e-5))
    assert seen > 300


def test_what_is_unknown_is_left_out():
    row = row_of(Intention(t=1.0, hand="left", status="lost", reason="gone"), None, True)
    assert set(row) == {"hand", "t", "status", "verb", "reason", "assisted"}


@pytest.mark.parametrize(("none", "subject"), [(0.98, None), (0.5, None), (0.49, "bleach")])
def test_a_hand_reaches_for_an_object_only_if_it_is_likelier_than_none(none, subject):
    said = Intention(
        t=1.0, hand="left", status="reaching", target="bleach", grip="palmar",
        probability={"bleach": 0.5 if none < 0.9 else 0.02, "none": none},
    )  # fmt: skip
    row = row_of(said, 0.2, True)
    assert row.get("subject") == subject
    assert ("undecided" in row["verb"]) == (subject is None)
    assert row["target"] == "bleach"  # as decided; the charts and the table keep it


def test_a_lease_is_told_with_its_end():
    lease = Commitment(target="soup", grip="pinch", since=0.5, valid_until=1.15)
    row = row_of(Intention(t=1.0, hand="left", status="reaching", commitment=lease), None, True)
    assert row["lease"] == {"target": "soup", "grip": "pinch", "valid_until": 1.15}


def test_the_scene_is_the_snapshot(moments):
    moment = moments[-1]
    names = {placed.model.name: k for k, placed in enumerate(moment.objects)}
    scene = json.loads(msgspec.json.encode(scene_of(moment, names)))
    for placed, shown in zip(moment.objects, scene["objects"], strict=True):
        assert shown["id"] == placed.id
        assert shown["position"] == pytest.approx(placed.translation, abs=1e-4)
        vertices = placed.model.vertices @ placed.rotation.T + placed.translation
        away = np.linalg.norm(vertices - shown["centre"], axis=1)
        assert away.max() <= shown["radius"] + 1e-3  # the whole object is within it
        assert shown["top"][2] > vertices[:, 2].max()
    for hand, shown in zip(moment.hands, scene["hands"], strict=True):
        assert shown["position"] == pytest.approx(hand.past[-1], abs=1e-4)
        assert len(shown["past"]) == 3 * (len(hand.past) - 1)
        hits, _ = rays_of(moment.scene, hand)
        if hand.intention.status == "reaching":
            assert shown["hits"] == pytest.approx(hits[::2].ravel(), abs=1e-4)


def test_a_mesh_arrives_whole(shapes):
    model = next(iter(shapes.values()))
    data = encode_mesh(model.vertices, model.faces)
    n, f = np.frombuffer(data, "<u4", 2)
    assert (n, f) == (len(model.vertices), len(model.faces))
    positions = np.frombuffer(data, "<f4", 3 * n, 8).reshape(-1, 3)
    normals = np.frombuffer(data, "<f4", 3 * n, 8 + 12 * n).reshape(-1, 3)
    faces = np.frombuffer(data, "<u4", 3 * f, 8 + 24 * n).reshape(-1, 3)
    assert len(data) == 8 + 24 * n + 12 * f
    np.testing.assert_allclose(positions, model.vertices, atol=1e-6)
    np.testing.assert_array_equal(faces, model.faces)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-5)
    outward = np.einsum("ij,ij->i", normals, positions - positions.mean(axis=0))
    assert (outward > 0).all()  # a box is convex


def test_corners_at_one_place_share_their_normal():
    """Else an outline, which grows along them, would show cracks."""
    corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 1], [1, 0, 0]]
    data = encode_mesh(np.array(corner, float), np.array([[0, 1, 2], [3, 4, 5]]))
    normals = np.frombuffer(data, "<f4", 18, 8 + 72).reshape(-1, 3)
    np.testing.assert_array_equal(normals[0], normals[3])
    np.testing.assert_array_equal(normals[1], normals[5])
