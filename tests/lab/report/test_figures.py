"""Figures of the report: legends cover nothing, and no two estimators look alike."""

from __future__ import annotations

import pytest

pytest.importorskip("matplotlib", reason="the extra 'report' is not installed")
from matplotlib.backends.backend_agg import FigureCanvasAgg

from igrip.lab.evaluation.trial_metrics import FRACTIONS
from igrip.lab.report.figures import (
    draw_accuracy,
    draw_calibration,
    draw_commitment,
    draw_participants,
    look_of,
)
from igrip.targets import TARGETS

KEYS = [f"{f:.0%}" for f in FRACTIONS]


def summary_of(names):
    """Return the parts of a summary that are drawn, with high and low lines everywhere."""
    scores = {"accuracy": dict.fromkeys(KEYS, 0.02), "accuracy_interval": dict.fromkeys(KEYS)}
    points = [{"right": p, "committed": p, "false_per_minute": p, "mean_part": p}
              for p in (0.0, 0.5, 1.0)]  # fmt: skip
    bins = [{"stated": p, "right": p} for p in (0.0, 0.5, 1.0)]
    one = {"valid": scores, "all": scores, "commitment": {"all": points},
           "calibration": {"ece": 0.1, "bins": bins}}  # fmt: skip
    return {"targets": dict.fromkeys(names, one)}


def participants():
    pandas = pytest.importorskip("pandas")
    rows = [
        {"recording": f"r{k}", "participant": f"p{k % 11:02d}", "target": "cup", "problem": None,
         "valid": True, "success": True, "grip_success": k % 3 > 0,
         "view": ("ipsi", "contra")[k % 2],
         "movement": ("executed", "simulated")[k // 2 % 2]} for k in range(88)
    ]  # fmt: skip
    return pandas.DataFrame(rows)


@pytest.mark.parametrize("count", [1, 5, len(TARGETS.names())])
@pytest.mark.parametrize("draw", [draw_accuracy, draw_calibration, draw_commitment])
def test_legends_cover_nothing(draw, count):
    check(draw(summary_of(TARGETS.names()[:count])), 1)


def test_legends_of_participants_cover_nothing():
    check(draw_participants(participants()), 9)


def check(figure, count):
    FigureCanvasAgg(figure).draw()
    legends = figure.legends + [one for panel in figure.axes if (one := panel.get_legend())]
    assert len(legends) == count
    for legend in legends:
        box = legend.get_window_extent()
        assert box.x0 >= 0
        assert box.y0 >= 0
        assert box.x1 <= figure.bbox.x1
        for panel in figure.axes:
            assert not box.padded(-1).overlaps(panel.get_window_extent())
            for text in (panel.title, panel.xaxis.label, panel.yaxis.label):
                if text.get_text():
                    assert not box.padded(-1).overlaps(text.get_window_extent()), text


def test_no_two_estimators_look_alike():
    looks = [look_of(k) for k in range(len(TARGETS.names()))]
    assert len(set(looks)) == len(looks)
