"""What was understood of a file: a table of its bodies and a picture from above."""

from __future__ import annotations

import string
from collections.abc import Mapping, Sequence

import numpy as np
from rich.console import Console

from igrip.cli.console import table_of
from igrip.io.inspection import Inspection, body_summary, extent_of
from igrip.io.takes.roles import hands_of
from igrip.io.takes.take import Take

WIDTH, HEIGHT = 60, 18  # characters of the picture
MAX_BODIES = 20
ROW = 2.0  # a character is about twice as high as wide


def print_inspection(console: Console, found: Inspection) -> None:
    """Print what is understood of one file."""
    console.print(f"{found.path}", style="bold", soft_wrap=True)
    console.print(f"  format: {found.layout}" + (f" ({found.dialect})" if found.dialect else ""))
    if found.columns:
        more = f", … ({len(found.columns)} in all)" if len(found.columns) > 10 else ""
        console.print(f"  columns: {', '.join(found.columns[:10])}{more}", soft_wrap=True)
    if found.problem:
        console.print(f"  {found.problem}", style="yellow", soft_wrap=True)
    take = found.take
    if take is None:
        return
    frame = take.frame
    axes = "" if frame.is_default or frame.axes == ("x", "y", "z") else (
        f"; our x, y, z are its {', '.join(frame.axes)}"
    )  # fmt: skip
    console.print(
        f"  {1.0 / take.interval:.4g} samples a second, {take.seconds:.4g} s; lengths in "
        f"{frame.length_unit}, times in {frame.time_unit}{axes}",
        soft_wrap=True,
    )
    letters = _letters(take)
    rows = []
    for key, letter in letters.items():
        summary = body_summary(take, key)
        low, high = summary.get("min_m", []), summary.get("max_m", [])
        where = [f"{a:.2f}…{b:.2f}" for a, b in zip(low, high, strict=True)] if low else ["-"] * 3
        kind = summary["kind"]
        rows.append((f"{letter} {key or '(x, y, z)'}", kind, str(summary["samples"]),
                     str(summary["missing"]), *where))  # fmt: skip
    console.print(
        table_of(("body", "kind", "seen", "missing", "x [m]", "y [m]", "z [m]"), rows, left=(1,))
    )
    if len(take.tracks) > len(letters):
        console.print(f"  … and {len(take.tracks) - len(letters)} more bodies")
    hands = ", ".join(f"{id}: {key}" for id, key in hands_of(take).items()) or (
        "the columns x, y, z" if "" in take.tracks else "none by its name"
    )
    console.print(f"  hands: {hands}", soft_wrap=True)
    for line in picture(take, letters):
        console.print(f"  {line}")
    for finding in found.findings:
        console.print(f"  {finding}", style="yellow", soft_wrap=True)


def picture(take: Take, letters: Mapping[str, str]) -> Sequence[str]:
    """Return the scene from above, y upwards: a letter where each body was; lines of text."""
    extent = extent_of(take)
    if extent is None:
        return ["(nothing was seen)"]
    low, high = extent
    scale = max((high[0] - low[0]) / (WIDTH - 1), (high[1] - low[1]) / (ROW * (HEIGHT - 1)), 1e-9)
    height = round((high[1] - low[1]) / (ROW * scale)) + 1
    canvas = np.full((height, WIDTH), " ")
    for key, letter in letters.items():
        points = take.tracks[key].positions
        columns = np.round((points[:, 0] - low[0]) / scale).astype(int)
        rows = height - 1 - np.round((points[:, 1] - low[1]) / (ROW * scale)).astype(int)
        canvas[np.clip(rows, 0, height - 1), np.clip(columns, 0, WIDTH - 1)] = letter
    ruler = f"from above: {WIDTH * scale:.3g} m wide, x to the right, y upwards"
    return [ruler, *("|" + "".join(row).rstrip() for row in canvas)]


def _letters(take: Take) -> dict[str, str]:
    keys = list(take.tracks)[:MAX_BODIES]
    return dict(zip(keys, string.ascii_uppercase, strict=False))
