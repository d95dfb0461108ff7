"""Groups on a table made of points."""

import numpy as np

from igrip.perception.registration.clusters import clusters_above


def table(random, width=1.0, depth=0.6):
    flat = random.uniform([-width / 2, 0.4, 0], [width / 2, 0.4 + depth, 0], (8000, 3))
    return flat + [0, 0, 1] * random.normal(0, 0.001, (8000, 1))


def block(random, x, y, size=0.05, low=0.0, high=0.1, count=800):
    return random.uniform(
        [x - size / 2, y - size / 2, low], [x + size / 2, y + size / 2, high], (count, 3)
    )


def groups(*parts):
    points = np.concatenate(parts)
    return clusters_above(points, np.full(len(points), 0.8), 0.001)


def test_two_blocks_three_centimetres_apart_are_two():
    random = np.random.default_rng(0)
    found = groups(table(random), block(random, 0, 0.7), block(random, 0.08, 0.7, high=0.2))
    assert len(found) == 2
    tops = sorted(group.top for group in found)
    assert 0.09 < tops[0] < 0.101
    assert 0.19 < tops[1] < 0.201


def test_what_hides_the_middle_of_a_thing_does_not_cut_it_in_two():
    random = np.random.default_rng(1)
    tall = block(random, 0, 0.7, high=0.25, count=3000)
    tall = tall[(tall[:, 2] < 0.08) | (tall[:, 2] > 0.18)]
    assert len(groups(table(random), tall)) == 1


def test_what_is_beside_the_table_or_passes_it_by_is_left_out():
    random = np.random.default_rng(2)
    beside = block(random, 0.8, 0.7)
    assert groups(table(random), beside) == []
    # its lower part is seen under the level of the table: it stands on the floor
    passing = block(random, 0.45, 0.9, low=-0.25, high=0.2, count=3000)
    assert groups(table(random), passing) == []


def test_nothing_on_the_table_gives_nothing():
    random = np.random.default_rng(3)
    assert groups(table(random)) == []
    assert groups(table(random), block(random, 0, 0.7, count=10)) == []
