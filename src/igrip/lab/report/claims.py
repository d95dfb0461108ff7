"""The results and claims of the publication, beside the results of an evaluation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple


class Published(NamedTuple):
    """One row of the paper's Table I: parts of frames and trials, delay and margin [s]."""

    frames: float
    success: float
    delay_s: float
    margin_s: float


TABLE_I = {
    "paper": Published(0.619, 0.899, 0.52, 0.67),
    "distance_derivative": Published(0.568, 0.720, 0.48, 0.72),
    "impacts": Published(0.157, 0.347, 0.97, 0.25),
    "distance": Published(0.536, 0.882, 0.59, 0.60),
    "future_distance": Published(0.596, 0.887, 0.52, 0.58),
}
GRIP = Published(float("nan"), 0.948, 0.39, 0.80)
VALID_SHARE, OBSERVED_SHARE = 1553 / 2718, 0.894
CONDITIONS = {
    "ipsi": (0.905, 0.955), "contra": (0.894, 0.942),
    "executed": (0.929, 0.947), "simulated": (0.868, 0.949),
}  # fmt: skip
"""Trial success of target and grip by side of the camera and by movement."""
SINGLES = ("impacts", "distance_derivative", "distance", "future_distance")


class Finding(NamedTuple):
    """One claim of the paper, whether it holds here, and the numbers."""

    claim: str
    holds: bool
    here: str


def findings(summary: Mapping[str, Any]) -> list[Finding]:
    """Compare the pattern of the paper's Table I with the valid trials of an evaluation."""
    known = {
        name: scores["valid"] for name, scores in summary["targets"].items()
        if scores["valid"].get("success") is not None
    }  # fmt: skip
    singles = {name: known[name] for name in SINGLES if name in known}
    complete = len(singles) == len(SINGLES)
    paper = known.get("paper", {})
    result: list[Finding] = []
    if paper and complete:
        best = max(singles, key=lambda name: singles[name]["success"])
        highest = singles[best]["success"]
        here = f"`paper` estimator {paper['success']:.1%}, best single `{best}` {highest:.1%}"
        holds = paper["success"] > highest
        result.append(Finding("the global score beats every single metric", holds, here))
    for key, how in (("delay_s", ""), ("delay_clipped_s", ", runs before the onset counted as 0")):
        delays = {name: s[key] for name, s in singles.items() if s[key] is not None}
        if len(delays) < len(SINGLES):
            continue
        order = sorted(delays, key=lambda name: delays[name])
        here = ", ".join(f"`{name}` {delays[name]:.2f} s" for name in order)
        earliest, latest = order[0] == "distance_derivative", order[-1] == "impacts"
        result.append(Finding(f"the distance derivative is the earliest{how}", earliest, here))
        result.append(Finding(f"impacts are the latest{how}", latest, here))
    if complete:
        worst = min(singles, key=lambda name: singles[name]["success"])
        here = f"`{worst}` {singles[worst]['success']:.1%}"
        result.append(Finding("impacts are the worst", worst == "impacts", here))
    if paper.get("grip_success") is not None:
        here = f"grip {paper['grip_success']:.1%}, target {paper['success']:.1%}"
        holds = paper["grip_success"] > paper["success"]
        result.append(Finding("the grip is found more often", holds, here))
    return result


def deviations(summary: Mapping[str, Any], max_difference: float = 0.10) -> list[str]:
    """Return the entries of Table I that differ from the paper's by more than a limit."""
    lines = []
    for name, published in TABLE_I.items():
        ours = summary["targets"].get(name, {}).get("valid", {})
        for key in ("frames", "success"):
            value, theirs = ours.get(key), getattr(published, key)
            if value is not None and abs(value - theirs) > max_difference:
                lines.append(f"`{name}`, {key}: {value:.1%}, published {theirs:.1%}")
    return lines
