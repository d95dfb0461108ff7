"""The report as one self-contained page, and the files beside it."""

from __future__ import annotations

import base64
import io
import json
import math
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import pandas as pd

from igrip.config import Config
from igrip.errors import MissingExtraError
from igrip.io.datasets.dataset import Dataset
from igrip.lab.evaluation.trial_metrics import FRACTIONS, NO_REACH
from igrip.lab.report import claims, figures, published
from igrip.lab.report.courses_figure import draw_courses, follow_trial
from igrip.objects.catalog import Catalog


def write_report(
    out: Path,
    dataset: Dataset,
    catalog: Catalog,
    frame: pd.DataFrame,
    summary: Mapping[str, Any],
    chosen: str | None = None,
) -> None:
    """Write ``summary.json``, ``trials.parquet``, ``figures/`` and ``report.html``.

    Parameters
    ----------
    out : Path
        Folder of the report.
    dataset, catalog : Dataset, Catalog
        What was evaluated.
    frame : DataFrame
        A row for each recording and estimator.
    summary : mapping
        Of :func:`igrip.lab.evaluation.summary.summarise`.
    chosen : str, optional
        Recording of the time courses; by default a typical one.

    Raises
    ------
    MissingExtraError
        If matplotlib, pyarrow or jinja2 is not installed.
    """
    try:
        import jinja2
    except ImportError as error:
        raise MissingExtraError("jinja2", "report", "the report") from error
    out.mkdir(parents=True, exist_ok=True)
    text = json.dumps(clean(summary), indent=2, ensure_ascii=False, allow_nan=False)
    (out / "summary.json").write_text(text + "\n", encoding="utf-8")
    try:
        frame.to_parquet(out / "trials.parquet", index=False)
    except ImportError as error:
        raise MissingExtraError("pyarrow", "report", "trials.parquet") from error
    first = next(iter(summary["targets"]))
    leading = "paper" if "paper" in summary["targets"] else first
    own = frame[frame["targets"] == leading]
    drawn = {
        "participants": figures.draw_participants(own),
        "accuracy": figures.draw_accuracy(summary),
        "calibration": figures.draw_calibration(summary),
        "commitment": figures.draw_commitment(summary),
        "courses": _courses(dataset, catalog, own, leading, chosen),
    }
    pictures = {name: _save(figure, out, name) for name, figure in drawn.items() if figure}
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"percent": percent, "seconds": seconds, "interval": interval}
    template = environment.from_string(
        (files("igrip.lab.report") / "report.html").read_text(encoding="utf-8")
    )
    page = template.render(
        summary=summary, pictures=pictures, leading=leading,
        fractions=[f"{f:.0%}" for f in FRACTIONS],
        table_i=published.TABLE_I, grip=published.GRIP, conditions=published.CONDITIONS,
        paper_valid=published.VALID_SHARE, paper_observed=published.OBSERVED_SHARE,
        findings=claims.findings(summary), deviations=claims.deviations(summary),
    )  # fmt: skip
    (out / "report.html").write_text(page, encoding="utf-8")


def typical(rows: pd.DataFrame) -> str | None:
    """Return the recording nearest to the medians of delay and margin among the successful."""
    reaches = rows[(rows["target"] != NO_REACH) & rows["problem"].isna()]
    for part in (reaches[reaches["valid"] == True], reaches):  # noqa: E712
        if "success" not in part or not (right := part[part["success"] == True]).shape[0]:  # noqa: E712
            continue
        numbers = right[["delay_s", "margin_s"]].astype(float)
        away = ((numbers - numbers.median()).abs()).sum(axis=1)
        return str(right["recording"].iloc[int(away.to_numpy().argmin())])
    return None


def _courses(
    dataset: Dataset, catalog: Catalog, rows: pd.DataFrame, targets: str, chosen: str | None
) -> Any | None:
    name = chosen or typical(rows)
    row = rows[(rows["recording"] == name) & rows["problem"].isna()]
    if not len(row) or "onset_s" not in row or pd.isna(row.iloc[0]["onset_s"]):
        return None
    trial = next(t for t in dataset.trials if t.recording == name)
    bounds = (float(row.iloc[0]["onset_s"]), float(row.iloc[0]["end_s"]))
    course = follow_trial(dataset, trial, catalog, Config(targets=targets), bounds)
    return draw_courses(course) if len(course.times) else None


def _save(figure: Any, out: Path, name: str) -> str:
    """Write a figure as PNG and SVG; return it for the page."""
    folder = out / "figures"
    folder.mkdir(exist_ok=True)
    figure.savefig(folder / f"{name}.png", dpi=200)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    (folder / f"{name}.svg").write_bytes(buffer.getvalue())
    return "data:image/svg+xml;base64," + base64.b64encode(buffer.getvalue()).decode()


def clean(value: Any) -> Any:
    """Return plain data in which what is not finite is null."""
    if isinstance(value, Mapping):
        return {key: clean(item) for key, item in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [clean(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def percent(value: float | None) -> str:
    """Return a part as people read it."""
    return "–" if value is None or not math.isfinite(value) else f"{100.0 * value:.1f} %"


def seconds(value: float | None) -> str:
    """Return a time as people read it."""
    return "–" if value is None or not math.isfinite(value) else f"{value:.2f}"


def interval(value: Sequence[float] | None) -> str:
    """Return an interval of parts as people read it."""
    return "" if not value else f"{100.0 * value[0]:.0f}–{100.0 * value[1]:.0f}"
