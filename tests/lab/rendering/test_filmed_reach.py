"""A reach before a rendered camera: what is drawn is where it truly is."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from igrip.lab.rendering.filmed_reach import MIDDLE, film_reach


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_objects_stand_where_the_protocol_put_them(ycb, seed):
    film = film_reach(ycb, seed)
    depth, labels = film.scene.truth()
    k = film.scene.intrinsics
    for number, (name, placed) in enumerate(film.scene.objects.items()):
        rows, columns = np.nonzero(labels == number)
        assert len(rows) > 200, name  # all are in the picture
        points = k.points(np.stack([columns, rows], axis=1).astype(float), depth[rows, columns])
        world = points @ film.scene.world_from_camera[:3, :3].T
        world += film.scene.world_from_camera[:3, 3]
        lowest = (placed.model.vertices @ placed.pose[:3, :3].T + placed.pose[:3, 3])[:, 2].min()
        assert lowest == pytest.approx(0.0, abs=1e-6)
        assert np.linalg.norm(world.mean(axis=0) - placed.pose[:3, 3]) < 0.2
    assert film.task.target in film.scene.objects


def test_the_hand_is_asked_for_at_the_true_palm(ycb):
    film = film_reach(ycb, 3)
    asked = []

    def put(frame, side, palm):
        asked.append((side, palm))
        return frame

    frames = list(itertools.islice(film.frames(put, begin=7.0), 0, 60, 20))
    world = film.scene.world_from_camera
    for frame, (side, palm) in zip(frames, asked[::20], strict=True):
        assert side == film.task.hand
        k = round((frame.t - 7.0) * 30)
        there = world[:3, :3] @ palm + world[:3, 3] + MIDDLE
        assert there == pytest.approx(film.done.palms[side][k], abs=1e-9)
        x, y = frame.intrinsics.pixels(palm[None])[0]
        assert 0 <= x < 640
        assert 0 <= y < 400


def test_a_seed_is_a_film(ycb):
    a, b = (next(film_reach(ycb, 5).frames(lambda frame, side, palm: frame)) for _ in range(2))
    assert (a.colour == b.colour).all()
    assert (a.depth == b.depth).all()
    other = next(film_reach(ycb, 6).frames(lambda frame, side, palm: frame))
    assert (a.colour != other.colour).any()
