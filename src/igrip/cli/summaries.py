"""What ``igrip replay`` prints at the end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import groupby, takewhile
from typing import Any

from rich.console import Console

from igrip.cli.console import number, table_of
from igrip.intention import Intention
from igrip.lab.evaluation.replay import FRACTIONS

MAX_LINES = 10  # of remarks and of problems


def recording_summary(
    path: str, targets: str, messages: int, seconds: float, intentions: Sequence[Intention]
) -> dict[str, Any]:
    """Return, for each hand of a recording, its reaches and the last target of each."""
    hands = sorted({intention.hand for intention in intentions})
    return {
        "recording": path, "targets": targets, "messages": messages, "seconds": seconds,
        "intentions": len(intentions),
        "hands": {hand: _hand([i for i in intentions if i.hand == hand]) for hand in hands},
    }  # fmt: skip


def _hand(intentions: Sequence[Intention]) -> dict[str, Any]:
    runs = [(status, list(run)) for status, run in groupby(intentions, key=lambda i: i.status)]
    return {
        "statuses": dict(Counter(intention.status for intention in intentions)),
        "reaches": [_reach(run) for status, run in runs if status == "reaching"],
    }


def _reach(intentions: Sequence[Intention]) -> dict[str, Any]:
    last = intentions[-1]
    settled = list(takewhile(lambda i: i.target == last.target, reversed(intentions)))
    return {
        "begin": intentions[0].t, "end": last.t, "target": last.target, "grip": last.grip,
        "confidence": last.confidence, "same_target_since": settled[-1].t,
    }  # fmt: skip


def print_recording(console: Console, summary: dict[str, Any]) -> None:
    """Print what :func:`recording_summary` returned."""
    console.print(
        f"{summary['recording']}: {summary['messages']} messages, {summary['seconds']:.1f} s, "
        f"{summary['intentions']} intentions by {summary['targets']}",
    )
    rows = [
        (
            hand, f"{reach['begin']:.2f}-{reach['end']:.2f} s", reach["target"] or "-",
            f"{reach['same_target_since'] - reach['begin']:.2f} s", reach["grip"] or "-",
            number(reach["confidence"]),
        )
        for hand, answers in summary["hands"].items() for reach in answers["reaches"]
    ]  # fmt: skip
    columns = ("hand", "reach", "target", "settled after", "grip", "score")
    console.print(table_of(columns, rows, left=(2, 4)) if rows else "no hand reached")


def _plain(value: Any) -> str:
    """Return nested values as a reader writes them: ``a 1, b 2; a 3``."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_plain(one)}" for key, one in value.items())
    if isinstance(value, list):
        between = "; " if any(isinstance(one, dict) for one in value) else " "
        return between.join(_plain(one) for one in value)
    return str(value)


def print_dataset(console: Console, summary: dict[str, Any]) -> None:
    """Print a :func:`igrip.lab.evaluation.replay.summarise_replay`."""
    console.print(
        f"{summary['dataset']}: {summary['trials']} trials of {summary['participants']} "
        f"participants; {summary['times_real_time']:.0f} × real time on "
        f"{summary['processes']} process(es)",
    )
    for key, value in (summary["derived"] or {}).items():
        console.print(f"  {key}: {_plain(value)}")
    shares = {
        "success": "success",
        **{f"accuracy_{part}": f"right at {part}" for part in FRACTIONS},
    }
    times = {"delay_s": "delay", "delay_clipped_s": "from onset on", "margin_s": "margin"}
    rows = [
        (
            row["targets"], row["group"], str(row["trials"]),
            *(_percent(row.get(key)) for key in shares),
            *(number(row.get(key), unit=" s") for key in times), *_contact(row),
        )
        for row in summary["results"]
    ]  # fmt: skip
    contact = (f"contact at {part}" for part in FRACTIONS)
    columns = ("targets", "group", "trials", *shares.values(), *times.values(), *contact)
    console.print(table_of(columns, rows, left=(1,), leading=2))
    print_trials(console, summary["remarks"], "remark")
    if summary["problems"]:
        console.print(f"{len(summary['problems'])} result(s) are missing:", style="yellow")
    print_trials(console, summary["problems"], "problem")


def _contact(row: dict[str, Any]) -> list[str]:
    """Return the median error of the predicted time of contact at parts of the movement."""
    parts = row.get("times", {}).get("contact", {})
    median = [parts.get(part, {}).get("median_s") for part in FRACTIONS]
    return [number(one and 1e3 * one, ".0f", " ms") for one in median]


def _percent(share: float | None) -> str:
    return number(share and 100 * share, ".1f", " %")


def print_trials(console: Console, rows: Sequence[dict[str, Any]], key: str) -> None:
    """Print what is to be known of some recordings, a line each."""
    for row in rows[:MAX_LINES]:
        name = row["recording"] + (f" ({row['targets']})" if "targets" in row else "")
        console.print(f"  {name}: {row[key]}", style="yellow", soft_wrap=True)
    if len(rows) > MAX_LINES:
        console.print(f"  … and {len(rows) - MAX_LINES} more", style="yellow")
