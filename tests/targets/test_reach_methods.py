"""The field's methods against scipy's densities and plain sums, on movements that are given."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

from frames import motion as motion_of
from igrip.geometry.cylinder import Cylinders
from igrip.motion.reach_detection import ReachDetector
from igrip.targets.gaussians import Gaussians
from igrip.targets.heading import MIN_SPEED, Heading
from igrip.targets.learned.features import LOCAL, features_of
from igrip.targets.learned.reach_library import AccumulatedLikelihood, ReachFrames, library_array
from igrip.targets.mixtures import STEP, Mixtures
from igrip.targets.nearest import Nearest
from igrip.targets.templates import Templates

PLACES = {"a": (0.0, 0.4, 0.0), "b": (0.25, 0.3, 0.05), "c": (-0.2, 0.1, 0.0)}


def geometry(ids="abc"):
    """Return small upright cylinders."""
    count = len(ids)
    cylinders = Cylinders.of(
        np.array([PLACES[id] for id in ids]).reshape(-1, 3),
        np.tile([0.0, 0.0, 1.0], (count, 1)), np.full(count, 0.05), np.full(count, 0.03),
        np.zeros((count, 3)),
    )  # fmt: skip
    return SimpleNamespace(
        objects=[SimpleNamespace(id=id) for id in ids], cylinders=lambda: cylinders
    )


def movement(rate=30.0, lasts=1.0, seed=0):
    """Return the motions of a hand that rests, reaches for a and rests again."""
    rng = np.random.default_rng(seed)
    detector, found = ReachDetector(), []
    for t in np.arange(0.0, 0.4 + lasts + 0.6, 1.0 / rate):
        s = np.clip((t - 0.4) / lasts, 0.0, 1.0)
        part = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        point = part * np.array(PLACES["a"]) + [0.03 * math.sin(math.pi * part), 0.0, 0.0]
        reach = detector.update(t, point + 3e-4 * rng.normal(size=3))
        found.append(SimpleNamespace(t=t, reach=reach))
    assert any(one.reach.moving for one in found)
    assert not found[-1].reach.moving
    return found


def coordinates(frames, ids="abc"):
    """Return elapsed, passed, place and length of each frame in which the hand moves."""
    rows, last = [], None
    for one in frames:
        if one.reach.moving:
            elapsed = one.t - one.reach.onset
            passed = elapsed if last is None else min(elapsed, one.t - last)
            local = features_of(one.reach, geometry(ids).cylinders()).local
            place = local[:, [LOCAL.index("progress"), LOCAL.index("deviation")]]
            length = [np.linalg.norm(np.array(PLACES[id]) - one.reach.start) for id in ids]
            rows.append((elapsed, passed, place, np.array(length)))
        last = one.t
    return rows


def test_the_frames_of_reaches():
    frames, tracker = movement(), ReachFrames()
    found = [tracker.update(one, geometry()) for one in frames]
    moving = [one for one in found if one is not None]
    assert [one is not None for one in found] == [one.reach.moving for one in frames]
    assert [one.begins for one in moving] == [True] + [False] * (len(moving) - 1)
    for one, (elapsed, passed, place, length) in zip(moving, coordinates(frames), strict=True):
        assert one.elapsed == pytest.approx(elapsed)
        assert one.passed == pytest.approx(passed)
        assert one.place == pytest.approx(place)
        assert one.length == pytest.approx(length)


def test_the_first_frame_of_all_counts_what_has_passed_since_the_onset():
    frames = movement()
    first = next(k for k, one in enumerate(frames) if one.reach.moving) + 5
    found = ReachFrames().update(frames[first], geometry())
    assert found.begins
    assert found.passed == pytest.approx(frames[first].t - frames[first].reach.onset)


def test_a_second_movement_begins_anew():
    tracker = ReachFrames()
    again = [SimpleNamespace(t=one.t + 10.0, reach=one.reach) for one in movement()]
    found = [tracker.update(one, geometry()) for one in [*movement(), *again]]
    assert sum(one.begins for one in found if one is not None) == 2


def test_nothing_to_reach_gives_no_frame():
    tracker = ReachFrames()
    assert all(tracker.update(one, geometry("")) is None for one in movement())


def shares(total):
    return np.exp(total - logsumexp(total))


def in_space(fit, place, length):
    """Return a density over progress and deviation as one in space, but for a constant."""
    return fit - 3.0 * np.log(length) - np.log(np.maximum(place[:, 1], 0.01))


def accumulated(density, step):
    """Return the probabilities after each frame, of a density of time and place."""
    total, found = np.zeros(3), []
    for elapsed, passed, place, length in coordinates(movement()):
        total = total + passed / step * in_space(density(elapsed, place), place, length)
        found.append(shares(total))
    return found


def gaussian_density(elapsed, place):
    step = float(library_array("gaussians", "step_s", shape=()))
    mean = library_array("gaussians", "mean", shape=(-1, 2))
    covariance = library_array("gaussians", "covariance", shape=(-1, 2, 2))
    k = min(round(elapsed / step), len(mean) - 1)
    return multivariate_normal(mean[k], covariance[k]).logpdf(place)


def mixture_density(elapsed, place):
    weight, mean = (library_array("mixture", key, shape=(-1,) * n)
                    for key, n in (("weight", 1), ("mean", 2)))  # fmt: skip
    covariance = library_array("mixture", "covariance", shape=(-1, 3, 3))
    at = np.column_stack([np.full(len(place), elapsed), place])
    parts = [
        np.log(w) + multivariate_normal(m, c).logpdf(at)
        for w, m, c in zip(weight, mean, covariance, strict=True)
    ]
    return logsumexp(parts, axis=0)


@pytest.mark.parametrize(
    ("method", "density", "step"),
    [(Gaussians, gaussian_density, 1.0 / 30.0), (Mixtures, mixture_density, STEP)],
)
def test_the_probabilities_are_those_of_the_summed_log_densities(method, density, step):
    one, found = method(), []
    for frame in movement():
        estimate = one.update(frame, geometry(), {})
        found.append((frame.reach.moving, estimate))
        assert estimate.probability is None
    moving = [estimate for moves, estimate in found if moves]
    for estimate, expected in zip(moving, accumulated(density, step), strict=True):
        assert estimate.scores == pytest.approx(expected, rel=1e-5, abs=1e-9)
        assert estimate.target == int(np.argmax(expected))
    before, after = found[0][1], found[-1][1]
    assert before.target is None
    assert before.scores.tolist() == [0.0, 0.0, 0.0]
    assert after.scores == pytest.approx(moving[-1].scores)  # a hand that has stopped keeps them


def test_a_movement_longer_than_the_library_is_compared_with_its_end():
    frame = next(one for one in movement()[::-1] if one.reach.moving)
    late = SimpleNamespace(t=frame.t, reach=frame.reach)
    method = Gaussians()
    coordinates_ = ReachFrames().update(late, geometry())._replace(elapsed=60.0, passed=1.0 / 30.0)
    method._frames = SimpleNamespace(update=lambda motion, geometry: coordinates_)
    found = method.update(late, geometry(), {}).scores
    place, length = coordinates_.place, coordinates_.length
    expected = shares(in_space(gaussian_density(60.0, place), place, length))
    assert found == pytest.approx(expected, rel=1e-6)


def added(total, objects, values, begins=False, elapsed=0.5, passed=0.1):
    reach = SimpleNamespace(begins=begins, elapsed=elapsed, passed=passed)
    return total.add(geometry(objects), reach, np.array(values))


def test_likelihoods_add_up_by_id_and_begin_anew_with_a_movement():
    total = AccumulatedLikelihood(0.1)
    assert added(total, "ab", [0.0, -1.0], begins=True) == pytest.approx(shares(np.array([0, -1])))
    assert added(total, "ba", [-1.0, 0.0]) == pytest.approx(shares(np.array([-2.0, 0.0])))
    assert added(total, "ab", [0.0, -1.0], passed=0.05) == pytest.approx(
        shares(np.array([0, -2.5]))
    )
    assert added(total, "ab", [-3.0, 0.0], begins=True) == pytest.approx(shares(np.array([-3, 0])))
    assert added(total, "ab", [0.0, -1.0], elapsed=0.1) == pytest.approx(shares(np.array([0, -1])))


def test_an_object_that_appears_is_as_likely_as_the_least_likely():
    total = AccumulatedLikelihood(0.1)
    added(total, "ab", [0.0, -1.0], begins=True)
    assert total.probability(geometry("abc")) == pytest.approx(shares(np.array([0, -1, -1])))
    assert added(total, "abc", [0.0, 0.0, 0.5]) == pytest.approx(shares(np.array([0, -1, -0.5])))
    assert total.probability(geometry("b")).tolist() == [1.0]
    assert AccumulatedLikelihood(0.1).probability(geometry("ab")).tolist() == [0.0, 0.0]
    assert total.probability(geometry("")).shape == (0,)


def template_ends():
    """Return the predicted end of each frame in which the hand moves, by plain sums."""
    step = float(library_array("templates", "step_s", shape=()))
    speeds = library_array("templates", "speed", shape=(-1, -1))
    lengths = library_array("templates", "distance", shape=(-1,))
    profile, apart, ends = [(0.0, 0.0)], np.zeros(len(lengths)), []
    frames = [one for one in movement() if one.reach.moving]
    for one, (elapsed, passed, _, _) in zip(frames, coordinates(movement()), strict=True):
        profile.append((elapsed, np.linalg.norm(one.reach.now[1])))
        steps = min(1 + int(elapsed / step), speeds.shape[1])
        so_far = np.interp(step * np.arange(steps), *np.array(profile).T)
        apart = apart + passed / step * np.abs(speeds[:, :steps] - so_far).mean(axis=1)
        offset = one.reach.now[0] - one.reach.start
        covered = np.linalg.norm(offset)
        ends.append(one.reach.start + offset / covered * max(covered, lengths[apart.argmin()]))
    return ends


def test_the_object_next_to_the_end_of_the_likest_template_is_the_target():
    method, found = Templates(), []
    for frame in [*movement(), *movement()]:
        found.append((frame.reach.moving, method.update(frame, geometry(), {})))
    half = len(found) // 2
    assert found[0][1].target is None
    assert found[0][1].scores.tolist() == [0.0, 0.0, 0.0]
    for part in (found[:half], found[half:]):  # the second movement as the first
        moving = [estimate for moves, estimate in part if moves]
        for estimate, end in zip(moving, template_ends(), strict=True):
            distance = np.linalg.norm(np.array(list(PLACES.values())) - end, axis=1)
            assert estimate.scores == pytest.approx(distance.min() / distance, rel=1e-6)
            assert estimate.target == int(distance.argmin())
        assert part[-1][1].scores == pytest.approx(moving[-1].scores)


def test_heading_is_half_of_one_plus_the_cosine():
    velocity = np.array([0.0, 0.3, 0.4])
    moving = motion_of(0.5)._replace(velocity=velocity, position=np.array([0.1, 0.0, 0.0]))
    towards = np.array(list(PLACES.values())) - [0.1, 0.0, 0.0]
    cosines = towards @ velocity / np.linalg.norm(towards, axis=1) / 0.5
    found = Heading().update(moving, geometry(), {})
    assert found.scores == pytest.approx(0.5 + 0.5 * cosines)
    assert found.target == int(cosines.argmax())


@pytest.mark.parametrize(("speed", "known"), [(MIN_SPEED, True), (0.99 * MIN_SPEED, False)])
def test_a_hand_below_the_minimal_speed_has_no_heading(speed, known):
    assert MIN_SPEED == 0.03
    moving = motion_of(speed)._replace(velocity=np.array([0.0, speed, 0.0]))
    found = Heading().update(moving, geometry(), {})
    assert (found.target is not None) == known
    assert (found.scores != 0.0).any() == known
    assert Heading().update(moving, geometry(""), {}).target is None


def test_a_hand_in_the_middle_of_an_object_heads_for_it_as_for_one_aside():
    moving = motion_of(0.5)._replace(
        velocity=np.array([0.5, 0.0, 0.0]), position=np.array(PLACES["a"])
    )
    assert Heading().update(moving, geometry(), {}).scores[0] == 0.5


def test_nearest_is_the_smallest_distance_over_ones_own():
    surface = np.array([0.4, 0.1, 0.2])
    found = Nearest().update(motion_of(), SimpleNamespace(surface=surface), {})
    assert found.scores == pytest.approx([0.25, 1.0, 0.5])
    assert found.target == 1
    touching = np.array([0.0, 2e-6])
    found = Nearest().update(motion_of(), SimpleNamespace(surface=touching), {})
    assert found.scores == pytest.approx([1.0, 0.5])
