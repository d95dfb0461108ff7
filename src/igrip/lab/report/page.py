"""The report as one self-contained page, and the files beside it."""

from __future__ import annotations

import base64
import io
import json
import math
import re
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import pandas as pd

from igrip.config import Config
from igrip.errors import requires_extra
from igrip.io.datasets.dataset import Dataset
from igrip.lab.evaluation.predicted_times import PARTS
from igrip.lab.evaluation.runner import run_trial
from igrip.lab.evaluation.summary import reaches_of, valid_of
from igrip.lab.evaluation.trial_metrics import FRACTIONS
from igrip.lab.report import claims, figures
from igrip.lab.report.courses_figure import draw_courses
from igrip.objects.catalog import Catalog
from igrip.version import __version__


def write_report(
    out: Path,
    dataset: Dataset,
    catalog: Catalog,
    configs: Sequence[Config],
    frame: pd.DataFrame,
    summary: Mapping[str, Any],
    chosen: str | None = None,
    command: str = "",
) -> None:
    """Write ``summary.json``, ``trials.parquet``, ``figures/`` and ``report.html`` to a folder.

    ``frame`` has a row for each recording and estimator, ``summary`` is that of
    :func:`igrip.lab.evaluation.summary.summarise`, ``chosen`` the recording of the time courses,
    by default a typical one, and ``command`` what was typed.

    Raises
    ------
    MissingExtraError
        If matplotlib, pyarrow or jinja2 is not installed.
    """
    with requires_extra("jinja2", "report", "the report"):
        import jinja2
        import markupsafe
    out.mkdir(parents=True, exist_ok=True)
    text = json.dumps(clean(summary), indent=2, ensure_ascii=False, allow_nan=False)
    (out / "summary.json").write_text(text + "\n", encoding="utf-8")
    with requires_extra("pyarrow", "report", "trials.parquet"):
        frame.to_parquet(out / "trials.parquet", index=False)
    leading = next((c for c in configs if c.targets == "paper"), configs[0])
    own = frame[frame["targets"] == leading.targets]
    drawn = {
        "participants": figures.draw_participants(own),
        "accuracy": figures.draw_accuracy(summary),
        "calibration": figures.draw_calibration(summary),
        "commitment": figures.draw_commitment(summary),
        "courses": _courses(dataset, catalog, leading, own, chosen),
    }
    pictures = {name: _save(figure, out, name) for name, figure in drawn.items() if figure}
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {
        "percent": percent, "seconds": seconds, "interval": interval, "error": error,
        "code": lambda text: markupsafe.Markup(
            re.sub(r"`([^`]+)`", r"<code>\1</code>", str(markupsafe.escape(text)))
        ),
        "at": lambda fraction: f"at {fraction}",
    }  # fmt: skip
    template = environment.from_string(
        (files("igrip.lab.report") / "report.html").read_text(encoding="utf-8")
    )
    page = template.render(
        summary=summary, pictures=pictures, leading=leading.targets,
        fractions=[f"{f:.0%}" for f in FRACTIONS], parts=[f"{part:.0%}" for part in PARTS],
        reliability=leading.commitment.reliability,
        version=__version__, command=command,
        configuration=leading.model_dump_json(indent=2, exclude={"targets"}),
        table_i=claims.TABLE_I, grip=claims.GRIP, conditions=claims.CONDITIONS,
        published_valid=claims.VALID_SHARE, published_observed=claims.OBSERVED_SHARE,
        findings=claims.findings(summary), deviations=claims.deviations(summary),
    )  # fmt: skip
    (out / "report.html").write_text(page, encoding="utf-8")


def typical(rows: pd.DataFrame) -> str | None:
    """Return the recording nearest to the medians of delay and margin among the successful."""
    reaches = reaches_of(rows)
    for part in (valid_of(reaches), reaches):
        right = part[part["success"].eq(True)]
        if len(right):
            times = right[["delay_s", "margin_s"]].astype(float)
            away = (times - times.median()).abs().sum(axis=1)
            return str(right["recording"].iloc[int(away.to_numpy().argmin())])
    return None


def _courses(
    dataset: Dataset, catalog: Catalog, config: Config, rows: pd.DataFrame, chosen: str | None
) -> Any | None:
    """Draw the time courses of one trial; None where there is none to draw."""
    name = chosen or typical(rows)
    row = reaches_of(rows)[lambda reaches: reaches["recording"] == name]
    if not len(row):
        return None
    trial = next(t for t in dataset.trials if t.recording == name)
    bounds = (float(row.iloc[0]["onset_s"]), float(row.iloc[0]["end_s"]))
    return draw_courses(run_trial(dataset, trial, catalog, [config]), bounds)


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
    """Return a share as a percentage."""
    return "–" if value is None or not math.isfinite(value) else f"{100.0 * value:.1f} %"


def seconds(value: float | None) -> str:
    """Return a time with two decimals [s]."""
    return "–" if value is None or not math.isfinite(value) else f"{value:.2f}"


def error(times: Mapping[str, Any]) -> str:
    """Return median and 90th percentile of the error of a predicted time [ms]."""
    median, ninety = times.get("median_s"), times.get("p90_s")
    return "–" if median is None or ninety is None else f"{1e3 * median:.0f} / {1e3 * ninety:.0f}"


def interval(value: Sequence[float] | None) -> str:
    """Return an interval of shares as percentages."""
    return "–" if not value else f"{100.0 * value[0]:.0f}–{100.0 * value[1]:.0f}"
