"""A reach as a plain table with its list of trials and its map, in the ways that tables differ."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from igrip.lab.simulation.minimum_jerk import reach

MAP = """
{unit}
{more}
[samples]
table = "take*"
[trials]
table = "list"
[objects.near]
x = -100.0
y = 400.0
z = 90.0
[objects.far]
x = 300.0
y = 300.0
z = 50.0
model = "005_tomato_soup_can"
"""
START, END = np.array([210.0, 15.0, 55.0]), np.array([-90.0, 350.0, 95.0])  # mm


def samples(rate: float = 100.0, seconds: float = 2.0) -> np.ndarray:
    """Return times [s] and positions [mm] of a reach with a little noise, shape (n, 4)."""
    t = np.arange(round(rate * seconds) + 1) / rate
    done = np.clip((t - 0.5) / 1.0, 0.0, 1.0)
    points = reach(START, END, 30.0, done)
    points = points + np.random.default_rng(1).normal(0.0, 0.4, points.shape)
    return np.column_stack([t, points])


def lines(table: np.ndarray, separator: str = ",", decimal: str = ".", header: str = "t,x,y,z",
          empty: str = "") -> list[str]:  # fmt: skip
    """Return a table as lines of text."""
    rows = [separator.join(header.split(","))] if header else []
    for row in table:
        cells = [f"{v:.4f}".replace(".", decimal) if np.isfinite(v) else empty for v in row]
        rows.append(separator.join(cells))
    return rows


def write(
    folder: Path, rows: list[str], name: str = "take1.csv", encoding: str = "utf-8",
    trials: str = "take1,P01,right,near\n", unit: str = 'unit = "mm"', more: str = "",
) -> Path:  # fmt: skip
    """Write the table, its list and its map; return the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    text = "\n".join(rows) + "\n"
    (folder / name).write_bytes(text.encode(encoding))
    (folder / "list.csv").write_bytes(("trial,participant,hand,target\n" + trials).encode(encoding))
    (folder / "map.toml").write_text(MAP.format(unit=unit, more=more))
    return folder
