"""Figures over all trials: participants (the published Figure 5), accuracy on the way."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from igrip.lab.evaluation.summary import reaches_of, valid_of
from igrip.lab.evaluation.trial_metrics import FRACTIONS
from igrip.lab.report.matplotlib_figure import new_figure

SPLITS = (
    ("all", None, {"all": "#333333"}),
    ("camera side", "view", {"ipsi": "#2e78c2", "contra": "#e88c2e"}),
    ("movement", "movement", {"executed": "#2ca02c", "simulated": "#b03a9c"}),
)
MARKERS = "osD^"  # with the colours, 32 estimators are told apart
COLOURS = ("#2ca02c", "#2e78c2", "#e88c2e", "#b03a9c", "#7a6a3a", "#d04040", "#3aa0a8", "#808080")


def draw_participants(rows: pd.DataFrame) -> Any:
    """Draw shares of valid trials, of targets and of grips found, for each participant.

    ``rows`` are those of one estimator.
    """
    reaches = reaches_of(rows)
    valid = valid_of(reaches)
    people = sorted(reaches["participant"].dropna().unique())
    figure = new_figure(10.0, 6.5, "the report")
    panels = figure.subplots(3, len(SPLITS), sharex=True, sharey=True)
    sources = (("valid trials", reaches, "valid"), ("target found", valid, "success"),
               ("grip found", valid, "grip_success"))  # fmt: skip
    for row, (label, source, column) in enumerate(sources):
        panels[row, 0].set_ylabel(f"{'ABC'[row]}  {label} [%]")
        if not len(source) or column not in source or source[column].isna().all():
            continue
        for k, (title, split, kinds) in enumerate(SPLITS):
            panel = panels[row, k]
            for offset, (kind, colour) in zip((-0.16, 0.16), kinds.items(), strict=False):
                part = source if split is None else source[source[split] == kind]
                if not len(part):
                    continue
                shares = 100.0 * part[column].astype(float).groupby(part["participant"]).mean()
                places = [people.index(name) + (offset if split else 0.0) for name in shares.index]
                panel.bar(places, shares.to_numpy(), 0.6 if split is None else 0.3, color=colour,
                          alpha=0.85, label=f"{kind}: mean {shares.mean():.1f}")  # fmt: skip
                panel.axhline(shares.mean(), color=colour, lw=1, ls="--")
            if panel.patches:  # above the panel, where it covers nothing
                panel.legend(fontsize=7, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2,
                             frameon=False, borderpad=0.0)  # fmt: skip
            if row == 0:
                panel.set_title(title, fontsize=9, pad=18)
            panel.set_ylim(0, 100)
            panel.set_xticks(range(len(people)), people, rotation=90, fontsize=6)
            if len(people) > 30:
                panel.set_xticks([])
    return figure


def draw_accuracy(summary: Mapping[str, Any]) -> Any:
    """Draw causal accuracy against the fraction of the movement, valid and all trials."""
    figure = new_figure(9.0, 4.2, "the report")
    panels = figure.subplots(1, 2, sharey=True)
    for panel, which in zip(panels, ("valid", "all"), strict=True):
        for k, (name, results) in enumerate(summary["targets"].items()):
            colour, marker = look_of(k)
            scores = results[which]
            if "accuracy" not in scores:
                continue
            at = [100.0 * f for f in FRACTIONS]
            curve = [100.0 * scores["accuracy"][f"{f:.0%}"] for f in FRACTIONS]
            panel.plot(at, curve, marker=marker, ms=3, color=colour, label=name)
            bands = [scores["accuracy_interval"][f"{f:.0%}"] for f in FRACTIONS]
            if all(bands):
                low, high = (100.0 * np.array(bands)).T
                panel.fill_between(at, low, high, color=colour, alpha=0.12, lw=0)
        panel.set_title(f"{which} trials", fontsize=9)
        panel.set_xlabel("part of the movement [%]")
        panel.grid(alpha=0.3)
    panels[0].set_ylabel("newest prediction is right [%]")
    panels[0].set_ylim(0, 100)
    _add_legend(figure, panels[1])
    return figure


def look_of(k: int) -> tuple[str, str]:
    """Return colour and marker of the k-th estimator; no pair comes twice among the first 32."""
    return COLOURS[k % len(COLOURS)], MARKERS[k // len(COLOURS) % len(MARKERS)]


def _add_legend(figure: Any, panel: Any, columns: int = 4) -> None:
    """Name the lines of a panel below all panels, where the names cover nothing."""
    lines, names = panel.get_legend_handles_labels()
    if lines:
        figure.legend(lines, names, loc="outside lower center", ncols=columns, fontsize=7)


def draw_calibration(summary: Mapping[str, Any]) -> Any | None:
    """Draw stated probability against the share of right answers; None without probabilities."""
    known = {n: t["calibration"] for n, t in summary["targets"].items() if t["calibration"]}
    if not known:
        return None
    figure = new_figure(5.0, 5.2, "the report")
    panel = figure.subplots()
    panel.plot([0, 100], [0, 100], color="grey", lw=0.8, ls=":")
    for k, (name, results) in enumerate(known.items()):
        colour, marker = look_of(k)
        stated = [100.0 * b["stated"] for b in results["bins"]]
        right = [100.0 * b["right"] for b in results["bins"]]
        panel.plot(
            stated,
            right,
            marker=marker,
            ms=4,
            color=colour,
            label=f"{name}: ECE {results['ece']:.3f}",
        )
    panel.set_xlabel("stated probability [%]")
    panel.set_ylabel("right [%]")
    _add_legend(figure, panel, 2)
    return figure


def draw_commitment(summary: Mapping[str, Any]) -> Any | None:
    """Draw the operating points of each estimator, from reactive to reliable."""
    curves = {n: t["commitment"]["all"] for n, t in summary["targets"].items()}
    curves = {n: rows for n, rows in curves.items() if rows and "committed" in rows[0]}
    if not curves:
        return None
    figure = new_figure(9.5, 3.8, "the report")
    axes = figure.subplots(1, 3)
    columns = (
        ("right", "first commitment is right [%]"), ("committed", "reaches committed for [%]"),
        ("false_per_minute", "false commitments a minute without a reach"),
    )  # fmt: skip
    for panel, (column, label) in zip(axes, columns, strict=True):
        for k, (name, rows) in enumerate(curves.items()):
            colour, marker = look_of(k)
            known = [r for r in rows if r.get(column) is not None]
            scale = 1.0 if column == "false_per_minute" else 100.0
            panel.plot(
                [100.0 * r["mean_part"] for r in known], [scale * r[column] for r in known],
                marker=marker, ms=3, lw=1, color=colour, label=name,
            )  # fmt: skip
        panel.set_xlabel("mean part of the movement [%]")
        panel.set_ylabel(label, fontsize=8)
        panel.grid(alpha=0.3)
    _add_legend(figure, axes[0])
    return figure
