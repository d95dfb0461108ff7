"""Charts and tables: values and gaps are those of the intentions; axes can be read."""

from __future__ import annotations

import csv
import io
import itertools

import pytest

from browser import needs_chromium
from igrip.describe import headline
from scripted_recording import DECIDED, END, GAP, LEASED, OTHER, UNDECIDED

pytestmark = [pytest.mark.browser, needs_chromium]
FIGURE_6 = "() => igrip.charts().right.global?.lines.length && igrip.settled()"


@pytest.fixture
def charts(shown):
    """The lines drawn for each hand and chart, by name."""
    shown.go(DECIDED)
    drawn = shown.page.evaluate("igrip.charts()")
    return {
        hand: {name: {line["name"]: line["segments"] for line in one["lines"]}
               for name, one in own.items() if one}
        for hand, own in drawn.items()
    }  # fmt: skip


def expected(snapshots, hand, value):
    """Return the segments of a quantity of a hand: broken at what is unknown, and at silence."""
    found, last = [], None
    for snapshot in snapshots:
        for one in snapshot.hands:
            if one.intention.hand != hand:
                continue
            v = value(one.intention)
            if v is not None:
                if last is None or snapshot.t - last > GAP:
                    found.append([])
                found[-1].append([pytest.approx(snapshot.t, abs=1e-4), pytest.approx(v, abs=1e-4)])
            last = snapshot.t if v is not None else None
    return found


def probability_of(id):
    return lambda intention: (intention.probability or {}).get(id)


def score_of(id, cue):
    return lambda intention: intention.scores.get(id, {}).get(cue)


@pytest.mark.parametrize("hand", ["left", "right"])
def test_probabilities_over_time_with_their_gaps(charts, snapshots, hand):
    assert set(charts[hand]["probability"]) == {"left", "soup", "none"}
    for id, segments in charts[hand]["probability"].items():
        assert segments == expected(snapshots, hand, probability_of(id))
        assert len(segments) == 2  # lost, or not measured, in the middle


def test_bars_of_target_grip_and_lease_do_not_bridge_gaps(charts, snapshots):
    drawn = charts["right"]["decision"]
    rows = ["left", "soup", "undecided", "palmar", "pinch", "permission"]
    assert list(drawn) == rows
    tests = {
        "left": lambda i: headline(i).target == "left",
        "soup": lambda i: headline(i).target == "soup",
        "undecided": lambda i: "undecided" in headline(i).verb,
        "palmar": lambda i: headline(i).target and i.grip == "palmar",
        "pinch": lambda i: headline(i).target and i.grip == "pinch",
        "permission": lambda i: i.commitment is not None,
    }
    for k, name in enumerate(rows):
        assert drawn[name] == expected(
            snapshots, "right", lambda i, k=k, holds=tests[name]: k if holds(i) else None
        ), name


def test_a_hand_has_one_target_at_a_time(charts):
    spans = sorted(
        (segment[0][0], segment[-1][0])
        for name in ("left", "soup", "undecided") for segment in charts["right"]["decision"][name]
    )  # fmt: skip
    assert len(spans) == 3
    for (_, end), (begin, _) in itertools.pairwise(spans):
        assert end < begin


def test_scores_of_each_cue_on_demand(shown, snapshots):
    shown.go(DECIDED)
    box = shown.page.locator("#scores")
    assert box.get_attribute("open") is None
    box.locator("summary").click()
    shown.page.wait_for_function(FIGURE_6)
    drawn = shown.page.evaluate("igrip.charts().right")
    assert {"speed", "distance", "distance_derivative", "global"} <= set(drawn)
    for cue in ("distance", "distance_derivative", "global"):
        for line in drawn[cue]["lines"]:
            assert line["segments"] == expected(snapshots, "right", score_of(line["name"], cue))
    box.locator("summary").click()


def test_several_hands_are_told_apart(shown):
    shown.go(DECIDED)
    for host in ("#charts", "#scores .columns"):
        columns = shown.page.locator(f"{host} .column")
        assert columns.evaluate_all("c => c.map(n => n.querySelector('h2').textContent)") == [
            "Left hand", "Right hand",
        ]  # fmt: skip


@pytest.mark.parametrize("width", [1280, 390])
def test_axes_have_names_and_units_and_no_text_is_cut_or_covered(shown, width):
    shown.page.set_viewport_size({"width": width, "height": 900})
    shown.page.locator("#scores").evaluate("n => n.open = true")
    shown.page.wait_for_function(FIGURE_6)
    shown.go(DECIDED)
    canvases = shown.page.locator(".chart canvas").evaluate_all(
        "all => all.map(c => ({ texts: c.texts, wide: c.clientWidth, high: c.clientHeight,"
        " name: c.parentElement.textContent }))"
    )
    assert len(canvases) == 2 * 6
    for canvas in canvases:
        texts = canvas["texts"]
        names = {text["text"] for text in texts}
        assert "time [s]" in names
        if "Decision" not in canvas["name"]:
            assert names & {"probability [%]", "speed [m/s]", "score"}, canvas["name"]
        for text in texts:
            assert text["left"] >= 0, (canvas["name"], text)
            assert text["right"] <= canvas["wide"], (canvas["name"], text)
            assert text["top"] >= 0, (canvas["name"], text)
            assert text["bottom"] <= canvas["high"], (canvas["name"], text)
        for k, a in enumerate(texts):
            for b in texts[k + 1 :]:
                apart = (
                    a["right"] <= b["left"] or b["right"] <= a["left"]
                    or a["bottom"] <= b["top"] or b["bottom"] <= a["top"]
                )  # fmt: skip
                assert apart, (canvas["name"], a, b)
    shown.page.locator("#scores").evaluate("n => n.open = false")
    shown.page.set_viewport_size({"width": 1280, "height": 1000})


def test_one_colour_means_one_object_and_never_colour_alone(shown):
    shown.go(DECIDED)
    lines = shown.page.evaluate("igrip.charts().right.probability.lines")
    looks = {line["name"]: (line["colour"], line["label"], tuple(line["dash"])) for line in lines}
    for k in range(3):  # colours, letters and dashes all differ
        assert len({look[k] for look in looks.values()}) == len(looks)
    bars = shown.page.evaluate("igrip.charts().right.decision.lines")
    for line in bars:
        if line["name"] in looks:
            assert line["colour"] == looks[line["name"]][0]
        else:
            assert line["colour"] not in {look[0] for look in looks.values()}
    for id, (colour, letter, _) in looks.items():
        row = shown.page.locator(f".card[data-hand=right] tr[data-object={id}]")
        painted = row.locator(".fill").evaluate("n => getComputedStyle(n).backgroundColor")
        red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
        assert painted == f"rgb({red}, {green}, {blue})"
        assert (row.locator(".letter").all_inner_texts() or [letter])[0] == letter


def test_the_cursor_stands_at_the_moment_that_is_shown_in_every_chart(shown):
    for moment in (DECIDED, OTHER):
        shown.go(moment)
        drawn = shown.page.evaluate("igrip.charts()")
        cursors = [one["cursor"] for own in drawn.values()
                   for name in ("probability", "decision") for one in [own[name]]]  # fmt: skip
        assert cursors == [pytest.approx(moment * 0.1, abs=1e-3)] * 4
        assert float(shown.page.locator("#slider").input_value()) == pytest.approx(moment * 0.1)


def test_a_click_into_a_chart_goes_to_that_time(shown):
    shown.go(UNDECIDED)
    sought = []
    shown.viewer.handle("seek", sought.append)
    frame = shown.page.evaluate("igrip.charts().right.probability.frame")
    assert (frame["from"], frame["to"]) == (0.0, pytest.approx(END))
    canvas = shown.page.locator("#charts .chart canvas").last
    canvas.click(position={"x": frame["left"] + 0.25 * frame["width"], "y": 60})
    for _ in range(600):
        if sought:
            break
        shown.page.wait_for_timeout(20)
    assert sought[0] == pytest.approx(0.25 * END, abs=0.02)


def test_the_table_has_the_numbers_of_each_hand(shown):
    said = shown.go(LEASED)["right"]
    rows = shown.page.locator("#table table tr").evaluate_all(
        "rows => rows.map(row => [...row.children].map(cell => cell.innerText.trim()))"
    )
    right = dict(zip((" ".join(head.split()) for head in rows[0]), rows[2], strict=True))
    assert right["hand"] == "Right hand"
    assert right["does"] == "reaches for"
    assert right["target"].split() == ["B", "soup"]
    assert right["B soup"] == f"{said.probability['soup']:.0%}".replace("%", " %")
    assert right["none"] == "20 %"
    assert right["grip"] == "pinch"
    assert right["contact in"] == "0.8 s"
    assert right["permission"] == "soup, until 2.32 s"


def test_all_values_can_be_saved_as_a_table(shown, snapshots):
    shown.go(DECIDED)
    with shown.page.expect_download() as download:
        shown.page.get_by_role("button", name="Save all values (CSV)").click()
    with open(download.value.path(), encoding="utf-8") as file:
        rows = list(csv.DictReader(io.StringIO(file.read())))
    said = [hand.intention for snapshot in snapshots for hand in snapshot.hands]
    assert len(rows) == len(said)
    for row, intention in zip(rows, said, strict=True):
        assert (float(row["t [s]"]), row["hand"]) == (intention.t, intention.hand)
        for id, p in (intention.probability or {}).items():
            assert float(row[f"p({id})"]) == pytest.approx(p, abs=1e-5)
