"""What the paper claims, looked for in the results at hand; said whether it holds or not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from igrip.lab.report.published import TABLE_I

SINGLES = ("impacts", "distance_derivative", "distance", "future_distance")


class Finding(NamedTuple):
    """One claim.

    Attributes
    ----------
    claim : str
        What the paper says.
    holds : bool
        Whether it holds here.
    here : str
        The numbers.
    """

    claim: str
    holds: bool
    here: str


def findings(summary: Mapping[str, Any]) -> list[Finding]:
    """Compare the pattern of the paper's Table I with the valid trials of an evaluation."""
    known = {
        name: told["valid"] for name, told in summary["targets"].items()
        if told["valid"].get("success") is not None
    }  # fmt: skip
    singles = {name: known[name] for name in SINGLES if name in known}
    found: list[Finding] = []
    if "paper" in known and len(singles) == len(SINGLES):
        best = max(singles, key=lambda n: singles[n]["success"])
        ours = known["paper"]["success"]
        text = f"paper {ours:.1%}, best single {best} {singles[best]['success']:.1%}"
        found.append(
            Finding(
                "the global score beats every single metric", ours > singles[best]["success"], text
            )
        )
    for key, how in (("delay_s", ""), ("delay_clipped_s", ", runs before the onset counted as 0")):
        delays = {n: s[key] for n, s in singles.items() if s[key] is not None}
        if len(delays) < len(SINGLES):
            continue
        order = sorted(delays, key=lambda n: delays[n])
        text = ", ".join(f"{n} {delays[n]:.2f} s" for n in order)
        first, last = order[0] == "distance_derivative", order[-1] == "impacts"
        found.append(Finding(f"the distance derivative is the earliest{how}", first, text))
        found.append(Finding(f"impacts are the latest{how}", last, text))
    if len(singles) == len(SINGLES):
        worst = min(singles, key=lambda n: singles[n]["success"])
        text = f"{worst} {singles[worst]['success']:.1%}"
        found.append(Finding("impacts are the worst", worst == "impacts", text))
    paper = known.get("paper", {})
    if paper.get("grip_success") is not None:
        text = f"grip {paper['grip_success']:.1%}, target {paper['success']:.1%}"
        found.append(
            Finding("the grip is found more often", paper["grip_success"] > paper["success"], text)
        )
    return found


def deviations(summary: Mapping[str, Any], most: float = 0.10) -> list[str]:
    """Name the parts of Table I that differ from the paper's by more than ``most``."""
    told = []
    for name, published in TABLE_I.items():
        ours = summary["targets"].get(name, {}).get("valid", {})
        for key in ("frames", "success"):
            value = ours.get(key)
            if value is not None and abs(value - getattr(published, key)) > most:
                told.append(f"{name}, {key}: {value:.1%}, paper {getattr(published, key):.1%}")
    return told
