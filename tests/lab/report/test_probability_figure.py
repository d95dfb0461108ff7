"""The plot of probabilities shows what the intentions hold, and no more."""

from __future__ import annotations

import numpy as np
import pytest

from igrip import Intention, plot_probability
from igrip.errors import IgripError
from igrip.io.intentions import Intentions
from igrip.lab.report.probability_figure import courses_of

RATE = 30.0


def intention(k, share, hand="right", status="reaching"):
    probability = None if share is None else {"mug": share, "can": 0.1, "none": 0.9 - share}
    return Intention(t=k / RATE, hand=hand, status=status, probability=probability)


def lines_of(figure, panel=0):
    return {line.get_label(): line for line in figure.axes[panel].get_lines()}


def test_the_lines_are_the_probabilities():
    shares = np.linspace(0.1, 0.8, 20)
    figure = plot_probability([intention(k, s) for k, s in enumerate(shares)])
    lines = lines_of(figure)
    assert list(lines) == ["mug", "can", "none"]  # none comes last
    np.testing.assert_allclose(lines["mug"].get_xdata(), np.arange(20) / RATE)
    np.testing.assert_allclose(lines["mug"].get_ydata(), shares)
    np.testing.assert_allclose(lines["none"].get_ydata(), 0.9 - shares)
    assert figure.axes[0].get_xlabel() == "time [s]"
    assert "probability" in figure.axes[0].get_ylabel()
    dashes = {str(line._unscaled_dash_pattern) for line in lines.values()}
    assert len(dashes) == 3  # told apart without colour, too


def test_gaps_are_not_bridged():
    lost = [3, 4, 5]
    given = [intention(k, None if k in lost else 0.5) for k in range(12)]
    times, values = courses_of(given, ["mug", "none"])
    assert np.isnan(values[:, lost]).all()
    assert np.isfinite(np.delete(values, lost, axis=1)).all()
    without = [i for k, i in enumerate(given) if k not in lost]  # no message at all
    times, values = courses_of(without, ["mug", "none"])
    between = (times > 2 / RATE) & (times < 6 / RATE)
    assert between.sum() == 1
    assert np.isnan(values[:, between]).all()


def test_one_lost_message_is_no_gap_unless_asked_for():
    given = [intention(k, 0.5) for k in range(12) if k != 5]
    assert np.isfinite(courses_of(given, ["mug"])[1]).all()
    assert np.isnan(courses_of(given, ["mug"], max_gap=1.5 / RATE)[1]).sum() == 1


def test_an_object_that_comes_later_has_no_probability_before():
    given = [Intention(t=0.0, hand="right", status="idle", probability={"none": 1.0}),
             intention(1, 0.4)]  # fmt: skip
    _, values = courses_of(given, ["mug", "none"])
    assert np.isnan(values[0, 0])
    assert values[0, 1] == 0.4


def test_a_panel_for_each_hand():
    given = [intention(k, 0.5, hand) for k in range(5) for hand in ("right", "left")]
    figure = plot_probability(given)
    assert [axes.get_ylabel().split()[0] for axes in figure.axes] == ["left", "right"]
    assert len(plot_probability(given, hand="left").axes) == 1


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_file_is_written(tmp_path, ending):
    plot_probability([intention(k, 0.5) for k in range(5)], tmp_path / f"p.{ending}")
    assert (tmp_path / f"p.{ending}").stat().st_size > 1000


def test_what_cannot_be_drawn_is_refused():
    with pytest.raises(IgripError, match="no intention to draw"):
        plot_probability([])
    with pytest.raises(IgripError, match="no intention has a probability"):
        plot_probability([Intention(t=0.0, hand="right", status="idle")])
    given = [intention(k, 0.5) for k in range(4)]
    several = Intentions(given, [{"recording": f"r{k % 2}", "targets": "bayes"} for k in range(4)])
    with pytest.raises(IgripError, match="recording=…; there are: r0, r1"):
        plot_probability(several)
    figure = plot_probability(several, recording="r1", max_gap=1.0)
    assert len(lines_of(figure)["mug"].get_xdata()) == 2
