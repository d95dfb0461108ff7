"""The page from which a person picks: the front from reliable to reactive."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from igrip.config import Config
from igrip.errors import requires_extra
from igrip.lab.report.matplotlib_figure import new_figure
from igrip.lab.tuning.space import values_of


def write_page(out: Path, record: Mapping[str, Any]) -> Path:
    """Write ``tune.html`` beside the files that it links to; return its path.

    ``record`` is that of :func:`igrip.lab.tuning.files.record_of`.

    Raises
    ------
    MissingExtraError
        If jinja2 or matplotlib is not installed.
    """
    with requires_extra("jinja2", "tune", "the page of tuning"):
        import jinja2
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"percent": percent, "rate": rate}
    source = (files("igrip.lab.tuning") / "tune.html").read_text(encoding="utf-8")
    defaults = values_of(Config())
    page = environment.from_string(source).render(
        record=record, defaults=defaults, default=record["values"] == defaults,
        picture=_embedded(draw_front(record["front"], record["present"])),
    )  # fmt: skip
    path = out / "tune.html"
    path.write_text(page, encoding="utf-8")
    return path


def draw_front(points: Sequence[Mapping[str, Any]], present: Mapping[str, Any]) -> Any:
    """Draw shares committed and right against the part of the movement; the present as crosses."""
    figure = new_figure(7.5, 4.0, "the page of tuning")
    axes = figure.subplots()
    for column, label, colour in (
        ("right", "first commitment is right", "#2ca02c"),
        ("committed", "reaches committed for", "#2e78c2"),
    ):
        known = [one for one in points if one[column] is not None]
        at = [100.0 * one["part"] for one in known]
        axes.plot(at, [100.0 * one[column] for one in known], "o-", ms=4, color=colour, label=label)
        if present[column] is not None:
            axes.plot(100.0 * present["part"], 100.0 * present[column], "x", ms=9, color=colour)
    for number, one in enumerate(points, 1):
        place = (100.0 * one["part"], 100.0 * one["committed"])
        axes.annotate(str(number), place, (0, 5), textcoords="offset points", fontsize=7)
    axes.axhline(95.0, color="#888888", lw=0.8, ls="--")
    axes.set_xlabel("mean part of the movement at the first commitment [%]")
    axes.set_ylabel("[%]")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7, loc="lower left")
    return figure


def _embedded(figure: Any) -> str:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    return "data:image/svg+xml;base64," + base64.b64encode(buffer.getvalue()).decode()


def percent(share: float | None) -> str:
    """Return a share as a percentage."""
    return "–" if share is None else f"{100.0 * share:.1f} %"


def rate(value: float | None) -> str:
    """Return a rate with two decimals."""
    return "–" if value is None else f"{value:.2f}"
