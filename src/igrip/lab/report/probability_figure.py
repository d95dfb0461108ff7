"""The probability of each candidate over time, as a figure for a paper."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.errors import IgripError
from igrip.intention import Intention
from igrip.io.intentions import Intentions, Item, read_intentions
from igrip.lab.report.matplotlib_figure import new_figure

Array = NDArray[np.float64]
NONE = "none"
# Okabe & Ito (2008), told apart by the colour-blind; line styles tell them apart without colour
COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442")
STYLES = ("-", "--", "-.", ":")
GAP = 2.5  # median intervals between messages; a longer one is a gap


def plot_probability(
    source: str | Path | Iterable[Item] | Intentions,
    out: str | Path | None = None,
    *,
    hand: str | None = None,
    recording: str | None = None,
    targets: str | None = None,
    max_gap: float | None = None,
) -> Any:
    """Draw the probability of each object, and of none, over time: one panel per hand.

    Where there is no probability (a hand that is lost or invalid, a stretch without messages) the
    lines are interrupted: gaps are not bridged.

    Parameters
    ----------
    source : str, Path, iterable of Intention, or Intentions
        What :func:`igrip.read_intentions` reads.
    out : str or Path, optional
        Write the figure here; the ending selects the format (.png, .svg, .pdf).
    hand, recording, targets : str, optional
        Draw these alone; needed where a file holds several recordings or estimators.
    max_gap : float, optional
        Lines are interrupted where no message of the hand came for longer [s]. Default: 2.5 times
        the median interval, so that one lost message is no gap.

    Returns
    -------
    matplotlib.figure.Figure
        For changes of your own; not bound to a window.

    Raises
    ------
    IgripError
        If nothing is left to draw, or there are several recordings or estimators.
    MissingExtraError
        If matplotlib is not installed.

    Examples
    --------
    >>> plot_probability("intentions.jsonl", "probability.svg")  # doctest: +SKIP
    """
    intentions = source if isinstance(source, Intentions) else read_intentions(source)
    chosen = _choose(intentions, hand, recording, targets)
    hands = {name: [i for i in chosen if i.hand == name] for name in sorted(
        {i.hand for i in chosen})}  # fmt: skip
    names = list(dict.fromkeys(name for i in chosen for name in i.probability or ()))
    names = [*(name for name in names if name != NONE), *(n for n in names if n == NONE)]
    if not names:
        raise IgripError("no intention has a probability: use an estimator that is calibrated")
    figure = new_figure(7.0, 1.0 + 2.2 * len(hands), "the plot of probabilities")
    panels = figure.subplots(len(hands), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    for panel, (name, own) in zip(panels, hands.items(), strict=True):
        times, values = courses_of(own, names, max_gap)
        for k, candidate in enumerate(names):
            panel.plot(times, values[k], label=candidate, **_style(k, candidate))
        panel.set(ylim=(-0.02, 1.02), ylabel=f"{name} hand\nprobability")
        panel.spines[["top", "right"]].set_visible(False)
    panels[-1].set_xlabel("time [s]")
    lines, labels = panels[0].get_legend_handles_labels()
    figure.legend(lines, labels, loc="outside right upper", frameon=False)
    if out is not None:
        figure.savefig(out, dpi=200)
    return figure


def courses_of(
    intentions: Sequence[Intention], names: Sequence[str], max_gap: float | None = None
) -> tuple[Array, Array]:
    """Return times (n,) [s] and the probabilities (len(names), n) of one hand; NaN interrupts.

    A sample of NaN stands within each gap longer than ``max_gap`` [s] (default: 2.5 times the
    median interval).
    """
    if max_gap is None:
        intervals = np.diff([intention.t for intention in intentions])
        max_gap = GAP * float(np.median(intervals)) if len(intervals) else np.inf
    times: list[float] = []
    values: list[list[float]] = []
    missing = [np.nan] * len(names)
    for intention in intentions:
        if times and intention.t - times[-1] > max_gap:
            times.append(0.5 * (times[-1] + intention.t))
            values.append(missing)
        given = intention.probability
        times.append(intention.t)
        values.append(missing if given is None else [given.get(name, np.nan) for name in names])
    return np.array(times), np.array(values).reshape(-1, len(names)).T


def _choose(
    intentions: Intentions, hand: str | None, recording: str | None, targets: str | None
) -> list[Intention]:
    wanted = {"recording": recording, "targets": targets}
    chosen, origins = [], []
    for intention, origin in zip(intentions, intentions.origins, strict=True):
        own = all(value is None or origin.get(key) == value for key, value in wanted.items())
        if own and hand in (None, intention.hand):
            chosen.append(intention)
            origins.append(origin)
    if not chosen:
        raise IgripError("there is no intention to draw")
    for key in wanted:
        found = sorted({str(origin[key]) for origin in origins if key in origin})
        if len(found) > 1:
            more = ", …" if len(found) > 5 else ""
            raise IgripError(f"choose one with {key}=…; there are: {', '.join(found[:5])}{more}")
    return chosen


def _style(k: int, candidate: str) -> dict[str, Any]:
    if candidate == NONE:
        return {"color": "#555555", "linestyle": (0, (1, 1)), "linewidth": 1.2}
    return {"color": COLOURS[k % len(COLOURS)], "linestyle": STYLES[k % len(STYLES)],
            "linewidth": 1.6, "marker": ".", "markersize": 3}  # fmt: skip
