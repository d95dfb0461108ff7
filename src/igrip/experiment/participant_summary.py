"""One page on one participant, right after the session: what was recorded, and how it went."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from statistics import median
from typing import Any

from igrip.config import Config
from igrip.errors import requires_extra
from igrip.experiment.folder import StudyFolder
from igrip.experiment.progress import AttemptState
from igrip.experiment.review import Review, ReviewedRecording
from igrip.io.whole_files import write_whole
from igrip.lab.evaluation.runner import run_trials
from igrip.lab.evaluation.trial_rows import Row, score_run
from igrip.lab.parallel import Workers, count_jobs
from igrip.objects.catalog import Catalog
from igrip.version import __version__

BEFORE, AFTER = 0.3, 0.5  # s of the profile that is drawn around a movement
WIDTH, HEIGHT, LABEL = 640, 180, 24  # of the figure, and of the line of text above its curves


def write_summary(
    folder: StudyFolder, review: Review, catalog: Catalog, config: Config,
    on_recording: Callable[[], object] = lambda: None,
) -> Path:  # fmt: skip
    """Write ``sessions/PARTICIPANT/summary.html``; return its path.

    Parameters
    ----------
    folder : StudyFolder
        Of the study.
    review : Review
        Of the participant, all recordings read.
    catalog : Catalog
        With the study's models.
    config : Config
        Of the estimator whose predictions are summed up.
    on_recording : function
        Called after each recording.

    Raises
    ------
    MissingExtraError
        If jinja2 is not installed.
    """
    with requires_extra("jinja2", "report", "the summary of a participant"):
        import jinja2
    counted = [one for one in review if not review.summary(one.trial.recording)["repeated"]]
    scores: dict[str, Row] = {}
    trials = [one.trial for one in counted]
    workers = Workers(count_jobs(0, len(trials)))
    for rows in run_trials(review.dataset, catalog, [config], score_run, trials, workers):
        scores |= {row["recording"]: row for row in rows}
        on_recording()
    rows = [review.summary(one.trial.recording) | _measured(one, review) for one in counted]
    for row in rows:
        row["success"] = scores[row["recording"]].get("success")
    states = Counter(one.state for one in folder.progress(review.participant).attempts)
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    source = resources.files(__package__).joinpath("pages", "summary.html").read_text("utf-8")
    page = environment.from_string(source).render(
        participant=review.participant, study=folder.study, version=__version__,
        done=len(folder.progress(review.participant).done), of=folder.study.trial_count,
        counts={state.value: states[state] for state in AttemptState if states[state]},
        recordings=len(rows), valid=sum(row["valid"] for row in rows),
        reasons=Counter(row["reason"] for row in rows if not row["valid"]).most_common(),
        levels=_by_level(folder, rows), total=_sum_up(rows), targets=config.targets,
        profiles=_profiles(counted, review), width=WIDTH, height=HEIGHT,
        duration=BEFORE + AFTER + 1.0,
    )  # fmt: skip
    path = folder.path / "sessions" / review.participant / "summary.html"
    write_whole(path, page)
    return path


def _measured(one: ReviewedRecording, review: Review) -> dict[str, float | None]:
    """Return duration [s] and peak speed [m/s] of a movement."""
    bounds = review.summary(one.trial.recording)["bounds"]
    if bounds is None:
        return {"movement_s": None, "peak": None}
    within = [speed for t, speed in one.speeds if bounds[0] <= t <= bounds[1]]
    return {"movement_s": bounds[1] - bounds[0], "peak": max(within, default=None)}


Sums = list[tuple[str, dict[str, Any]]]
"""Levels, and what the recordings of each add up to."""


def _by_level(folder: StudyFolder, rows: Sequence[Mapping[str, Any]]) -> list[tuple[str, Sums]]:
    """Return the sums of each level of each factor of the study, and of each camera."""
    factors = {**folder.study.factors, "camera": folder.study.cameras}
    found = []
    for factor, levels in factors.items():
        of = [row["camera"] if factor == "camera" else row["levels"][factor] for row in rows]
        parts = {level: [r for r, own in zip(rows, of, strict=True) if own == level]
                 for level in levels}  # fmt: skip
        found.append((factor, [(level, _sum_up(part)) for level, part in parts.items()]))
    return found


def _sum_up(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return counts, medians and the share of trials in which the estimator was right."""
    valid = [row for row in rows if row["valid"]]
    durations = [row["movement_s"] for row in valid]
    peaks = [row["peak"] for row in valid if row["peak"] is not None]
    right = [bool(row["success"]) for row in valid if row["success"] is not None]
    return {
        "recordings": len(rows), "valid": len(valid),
        "movement_s": median(durations) if durations else None,
        "peak": median(peaks) if peaks else None,
        "right": sum(right), "scored": len(right),
    }  # fmt: skip


def _profiles(counted: Sequence[ReviewedRecording], review: Review) -> dict[str, Any]:
    """Return the speed profiles of valid movements from their onset, as lines of a figure."""
    chosen = []
    for one in counted:
        row = review.summary(one.trial.recording)
        if row["valid"] and row["bounds"]:
            begin, end = row["bounds"][0] - BEFORE, row["bounds"][0] + 1.0 + AFTER
            chosen.append([(t - begin, v) for t, v in one.speeds if begin <= t <= end])
    top = max((v for line in chosen for _, v in line), default=1.0)
    across = WIDTH / (BEFORE + AFTER + 1.0)
    lines = [
        " ".join(f"{t * across:.1f},{HEIGHT - v / top * (HEIGHT - LABEL):.1f}" for t, v in line)
        for line in chosen
    ]
    return {"lines": lines, "top": top, "onset": BEFORE * across}
