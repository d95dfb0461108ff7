"""The plausibility check: units and frames by their effect on known scenes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.io.frames import METRES, SECONDS
from igrip.io.missing_markers import missing_rows
from igrip.io.plausibility import (
    Samples,
    check_extents,
    check_length,
    check_samples,
    check_sizes,
    check_times,
    check_up,
    refusal,
)

TIMES = np.arange(60) / 30.0
REACH = np.stack([0.2 - 0.2 * TIMES, 0.2 * TIMES, 0.05 + 0.02 * TIMES], axis=1)
UPRIGHT = np.tile([0.0, 0.0, 0.0, 1.0], (60, 1))


def scene(length=1.0, time=1.0, turn=None):
    turn = turn or Rotation.identity()
    place = np.tile([0.0, 0.4, 0.0], (60, 1))
    orientations = (turn * Rotation.from_quat(UPRIGHT)).as_quat()
    hand = Samples(time * TIMES, length * turn.apply(REACH))
    other = np.tile([0.3, 0.3, 0.1], (60, 1))
    objects = {
        "mug": Samples(time * TIMES, length * turn.apply(place), orientations),
        "box": Samples(time * TIMES, length * turn.apply(other), orientations),
    }
    return {"right": hand}, objects


def test_a_plain_scene_has_no_findings():
    assert check_samples(*scene()) == []


@pytest.mark.parametrize(("unit", "taken"), [("mm", "m"), ("cm", "m"), ("m", "mm"), ("m", "cm")])
def test_a_wrong_unit_of_length_is_refused_with_the_one_that_fits(unit, taken):
    text = refusal(check_samples(*scene(METRES[taken] / METRES[unit]), length_unit=taken))
    assert text is not None
    assert f" in {unit}" in text


@pytest.mark.parametrize(("unit", "taken"), [("m", "m"), ("mm", "cm"), ("cm", "mm")])
def test_a_scene_of_four_centimetres_or_four_metres_may_be_meant_so(unit, taken):
    assert check_samples(*scene(METRES[taken] / METRES[unit]), length_unit=taken) == []


@pytest.mark.parametrize(("unit", "factor"), [("cm", 100.0), ("in", 1 / 0.0254)])
@pytest.mark.parametrize("distance", [0.12, 0.18, 0.4])
@pytest.mark.parametrize("rate", [30.0, 100.0, 240.0])
@pytest.mark.parametrize("rest", [0.0, 1.0])
def test_a_reach_in_small_units_is_refused_even_where_it_spans_few_metres(
    unit, factor, distance, rate, rest
):
    times = np.arange(round((rest + 0.9) * rate)) / rate
    done = np.clip((times - rest) / 0.9, 0.0, 1.0)
    done = 10 * done**3 - 15 * done**4 + 6 * done**5
    points = np.stack([distance * done, 0.3 * distance * done, 0.05 + 0.0 * done], axis=1)
    points += np.random.default_rng(0).normal(0.0, 2e-4, points.shape)
    hands, objects = {"right": Samples(times, factor * points)}, {}
    text = refusal(check_samples(hands, objects))
    assert text is not None
    assert {"in": "inches"}.get(unit, unit) in text.split("positions in")[1]
    assert refusal(check_samples({"right": Samples(times, points)}, objects)) is None


@pytest.mark.parametrize("seed", range(5))
def test_a_hand_that_jumps_or_a_person_who_walks_is_not_refused(seed):
    random = np.random.default_rng(seed)
    times = np.arange(300) / 100.0
    walk = np.stack([2.0 * times, 0.3 * np.sin(6 * times), 1.0 + 0.0 * times], axis=1)
    assert refusal(check_samples({"right": Samples(times, walk)}, {})) is None
    swapped = np.where(random.random((300, 1)) < 0.3, [[6.0, 0.0, 1.0]], 0.05 * walk)
    assert refusal(check_samples({"right": Samples(times, swapped)}, {})) is None


@pytest.mark.parametrize("up", ["x", "y"])
def test_a_scene_in_a_layer_is_remarked_though_its_objects_are_upright(up):
    hands, objects = scene()
    order = {"y": [0, 2, 1], "x": [2, 1, 0]}[up]
    turned = {
        id: Samples(s.times, s.positions[:, order] + 1e-4, s.orientations)
        for id, s in objects.items()
    }
    far = np.tile(np.array([[-0.2, 0.05, 0.1]])[:, [0, 1, 2]], (60, 1))
    turned["far"] = Samples(TIMES, far[:, order] + [0.0, 0.0, 0.0], UPRIGHT)
    moved = {"right": Samples(TIMES, hands["right"].positions[:, order])}
    texts = [f.text for f in check_samples(moved, turned) if f.kind == "up"]
    assert any(f'up = "{up}"' in text for text in texts)


@pytest.mark.parametrize("rate", [15.0, 30.0, 60.0, 100.0, 120.0, 240.0])
@pytest.mark.parametrize("unit", ["ms", "us", "ns"])
def test_a_wrong_unit_of_time_is_refused_with_the_one_that_fits(rate, unit):
    text = refusal(check_times(np.arange(30) / rate / SECONDS[unit]))
    assert text is not None
    assert f"are these {unit}?" in text.replace(f" {unit} or", f" {unit}? or")


@pytest.mark.parametrize("rate", [3.0, 15.0, 30.0, 240.0, 1000.0])
def test_usual_rates_pass(rate):
    assert check_times(np.arange(30) / rate) == []


def test_a_second_between_samples_is_remarked():
    (finding,) = check_times(1.1 * np.arange(30.0))
    assert finding.verdict == "remark"


def test_microseconds_taken_for_seconds_are_refused_before_anything_is_made():
    assert "6.3e+07" in refusal(check_length(np.arange(63) * 33_870.0, 30.0))
    assert check_length(np.arange(0.0, 3600.0, 0.01), 30.0) == []


@pytest.mark.parametrize(
    ("turn", "named"),
    [
        (Rotation.from_euler("x", -90, degrees=True), "up = y"),
        (Rotation.from_euler("x", 90, degrees=True), "up = -y"),
        (Rotation.from_euler("y", 90, degrees=True), "up = x"),
        (Rotation.from_euler("x", 180, degrees=True), "up = -z"),
    ],
)
def test_objects_that_all_lie_or_hang_name_the_axis(turn, named):
    (finding,) = check_samples(*scene(turn=turn))
    assert finding.verdict == "remark"
    assert named in finding.text


def test_one_object_that_lies_among_others_is_no_matter():
    lying = Rotation.from_euler("x", 90, degrees=True).as_quat()
    assert check_up({"banana": [lying], "mug": [[0, 0, 0, 1]]}, {}) == []


def test_places_alone_can_show_the_axis():
    places = {"near": [[0.0, 0.1, 0.2]], "far": [[0.1, 0.1, 0.4]]}
    assert "up = y" in check_up({}, places)[0].text


def test_a_stray_point_is_no_matter_of_the_unit():
    points = REACH.copy()
    points[7] = 900.0
    assert check_extents({"right": points}) == []


def test_sizes_name_every_unit_that_fits():
    assert "mm" in check_sizes({"mug": [96.0, 80.0, 80.0]})[0].text
    assert "cm or mm" in check_sizes({"tray": [30.0, 20.0, 2.1]})[0].text
    assert check_sizes({"mug": [0.096, 0.08, 0.08]}) == []


def test_what_stands_for_missing():
    rows = [[1, 2, 3], [0, 0, 0], [0, 0, 0], [-9999, 1, 2], [999, 999, 999], [np.nan, 1, 1],
            [999, 1, 2], [99999.99, 0, 0], [-3.4e38, 0, 1]]  # fmt: skip
    expected = [False, True, True, True, True, True, False, True, True]
    assert missing_rows(rows).tolist() == expected


def test_zeros_are_missing_only_away_from_the_rest():
    away = np.array([0.2, 0.3, 0.1]) + 0.01 * np.arange(4)[:, None]
    for count in (1, 2, 10):
        zeros = np.zeros((count, 3))
        for rows in ([away, zeros, away], [zeros, away], [away, zeros]):
            joined = np.concatenate(rows)
            assert missing_rows(joined).tolist() == (joined == 0.0).all(axis=1).tolist()


def test_a_movement_may_begin_and_end_at_the_origin():
    rest, reach = np.zeros((30, 3)), 0.01 * np.arange(1, 40)[:, None] * [0.0, 1.0, 0.1]
    assert not missing_rows(np.concatenate([rest, reach, reach[::-1], rest])).any()


def test_an_object_may_stand_at_the_origin():
    assert not missing_rows(np.zeros((5, 3)), may_rest_at_zero=True).any()
    assert missing_rows(np.zeros((5, 3))).all()


def test_a_sender_that_repeats_itself_and_speeds_of_no_hand_are_remarked():
    repeated = Samples(TIMES, REACH[np.arange(60) // 4 * 4])
    assert [f.kind for f in check_samples({"right": repeated}, {})] == ["repeats"]
    rests = Samples(np.arange(90) / 30.0, np.concatenate([np.tile(REACH[0], (60, 1)), REACH[:30]]))
    assert check_samples({"right": rests}, {}) == []
    fast = Samples(TIMES / 1000.0, REACH)
    assert "speed" in [f.kind for f in check_samples({"right": fast}, {})]


def reach_in(unit: float, seconds: float = 2.0):
    """Return a hand that reaches over 0.4 m within the middle second, in a unit [m]."""
    times = np.arange(round(100 * seconds)) / 100
    done = np.clip(times - 0.5, 0.0, 1.0)
    done = 10 * done**3 - 15 * done**4 + 6 * done**5
    return Samples(times, np.column_stack([0.4 * done, 0.1 * done, 0.05 + 0.0 * done]) / unit)


@pytest.mark.parametrize(("unit", "name", "verdict"), [(0.0254, "in", "refuse"),
                                                       (0.1, "dm", "remark")])  # fmt: skip
def test_a_hand_that_is_too_fast_over_too_long_a_way(unit, name, verdict):
    [found] = check_samples({"right": reach_in(unit)}, {})
    assert (found.verdict, found.fix) == (verdict, ("length_unit", name))
    assert check_samples({"right": reach_in(1.0)}, {}) == []


def test_a_person_who_walks_is_plausible():
    times = np.arange(1000) / 100
    walk = np.column_stack([1.5 * times, 0.1 * np.sin(times), 1.0 + 0.0 * times])
    assert check_samples({"right": Samples(times, walk)}, {}) == []


@pytest.mark.parametrize("begin", [0, 1, 5000])
def test_frame_numbers_are_no_times(begin):
    [found] = check_times(np.arange(begin, begin + 200.0))
    assert found.verdict == "refuse"
    assert "ms or frame numbers" in found.text
