"""The card of each hand: sentence, bars, grip, time of contact and lease are the intention's."""

from __future__ import annotations

import pytest

from browser import needs_chromium
from igrip.runtime.protocol import Command
from scripted_recording import DECIDED, LEASED, LOST, OTHER, STEP, UNDECIDED

pytestmark = [pytest.mark.browser, needs_chromium]


def card(shown, hand):
    return shown.page.locator(f".card[data-hand={hand}]")


@pytest.mark.parametrize(
    ("moment", "sentence"),
    [
        (3, "rests"), (UNDECIDED, "moves, undecided"), (DECIDED, "reaches for B soup"),
        (LOST, "is lost"), (OTHER, "reaches for A object “left”"),
    ],
)  # fmt: skip
def test_a_sentence_in_large_type_says_what_the_hand_does(shown, moment, sentence):
    shown.go(moment)
    words = card(shown, "right").locator(".sentence")
    assert " ".join(words.inner_text().split()) == sentence
    assert float(words.evaluate("n => getComputedStyle(n).fontSize").removesuffix("px")) >= 20
    assert card(shown, "right").locator("h2").inner_text() == "Right hand"


def test_a_hand_that_is_not_measured_any_more_says_so(shown):
    shown.go(UNDECIDED)
    assert card(shown, "left").locator(".sentence").inner_text() == "is not measured"
    assert card(shown, "left").locator(".number").all_inner_texts() == ["–"] * 3


@pytest.mark.parametrize("moment", [3, UNDECIDED, DECIDED, OTHER])
def test_the_bars_are_the_probabilities(shown, moment):
    said = shown.go(moment)
    for hand, intention in said.items():
        bars = card(shown, hand).locator("tr[data-object]")
        ids = bars.evaluate_all("rows => rows.map(row => row.dataset.object)")
        assert set(ids) == set(intention.probability)
        for k, id in enumerate(ids):
            p, row = intention.probability[id], bars.nth(k)
            assert row.locator(".number").inner_text() == f"{p * 100:.0f} %"
            share = row.evaluate(
                "row => row.querySelector('.fill').getBoundingClientRect().width"
                " / row.querySelector('.track').clientWidth"
            )
            assert share == pytest.approx(p, abs=0.03)


def test_only_a_target_that_is_likelier_than_none_is_marked(shown):
    for moment, chosen in ((UNDECIDED, []), (DECIDED, ["soup"]), (OTHER, ["left"]), (LOST, [])):
        shown.go(moment)
        marked = card(shown, "right").locator("tr.chosen")
        assert marked.evaluate_all("rows => rows.map(row => row.dataset.object)") == chosen


def test_grip_and_time_to_contact_are_told_with_a_target_only(shown):
    shown.go(DECIDED)
    detail = card(shown, "right").locator(".detail")
    assert detail.inner_text() == "pinch grip (75 %) · contact in 0.8 s (0.5–1.3 s)"
    shown.go(UNDECIDED)
    assert detail.inner_text() == ""
    shown.go(LOST)
    assert detail.inner_text() == "out of sight"


def test_a_lease_has_its_countdown(shown):
    shown.go(LEASED)
    assert card(shown, "right").locator(".lease-text").inner_text() == (
        "Permission: pinch grip of soup"
    )
    assert card(shown, "right").locator(".left").inner_text() == "0.12 s"
    assert card(shown, "right").locator("progress").evaluate("n => n.value") == pytest.approx(0.12)
    shown.go(3)
    assert card(shown, "right").locator(".lease-text").inner_text() == "No permission to act"
    assert card(shown, "left").locator(".lease-text").inner_text() == "No device assists this hand"
    assert card(shown, "right").locator("progress").evaluate("n => n.value") == 0


def test_silence_is_seen_to_end_a_lease(chromium, snapshots):
    """Nothing more comes after the lease was given; the countdown runs out by itself."""
    from igrip.viewer.server import Viewer

    viewer = Viewer(port=0)
    page = chromium.new_page()
    try:
        page.goto(viewer.url)
        viewer.show(snapshots[LEASED])
        page.get_by_text("Permission expired").wait_for(timeout=60_000)
        assert page.locator(".permitted").count() == 0
    finally:
        page.close()
        viewer.close()


def test_veto_and_confirm_reach_igrip_for_the_hand_that_is_assisted(shown):
    shown.go(LEASED)
    assert card(shown, "left").get_by_role("button").count() == 0
    for name in ("Veto", "Confirm", "Device opened"):
        card(shown, "right").get_by_role("button", name=name).click()
    shown.go(DECIDED)
    expected = [Command(action, "right") for action in ("veto", "confirm", "opened")]
    for _ in range(600):
        if len(shown.commands) == 3:
            break
        shown.page.wait_for_timeout(20)
    assert shown.commands == expected


def test_without_probabilities_scores_are_not_called_probabilities(chromium, snapshots):
    from dataclasses import replace

    import msgspec

    from igrip.viewer.server import Viewer

    moment = snapshots[DECIDED]
    hand = next(h for h in moment.hands if h.intention.hand == "right")
    said = msgspec.structs.replace(hand.intention, probability=None)
    viewer = Viewer(port=0)
    page = chromium.new_page()
    try:
        page.goto(viewer.url)
        viewer.show(replace(moment, hands=[replace(hand, intention=said)]))
        page.locator("tr[data-object=soup] .number").get_by_text("0.35").wait_for()
        assert page.locator(".bars thead").inner_text().split("\t")[-1] == (
            "score (not a probability)"
        )
        assert page.locator("tr[data-object=none]").count() == 0
        assert page.get_by_text("Score of each object (not a probability)").count() == 1
    finally:
        page.close()
        viewer.close()


def test_the_step_of_the_script_is_what_these_tests_assume(snapshots):
    assert snapshots[LEASED].t == pytest.approx(LEASED * STEP)
