"""The picture of a benchmark: medians beside the peers, and growth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from igrip.lab.report.matplotlib_figure import new_figure
from igrip.lab.speed.peers import TRIMESH


def draw(report: dict[str, Any], path: Path) -> None:
    """Write the picture of a report; the ending of the path chooses PNG or SVG.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    figure = new_figure(10.0, 4.0, "the picture of a benchmark")
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    rows = dict(report["peers"]["best"])
    if report["peers"]["plain_trimesh"]:
        rows[TRIMESH] = report["peers"]["plain_trimesh"]
    names = list(rows)
    left.barh(names, [rows[name]["p50_ms"] for name in names], color="#4878a8")
    left.plot([rows[name]["p99_ms"] for name in names], names, "k|", markersize=12, label="p99")
    left.set_xscale("log")
    left.set_xlabel("ms per frame (bars: median)")
    left.set_title("2 hands, 4 objects of 16 k faces")
    left.invert_yaxis()
    left.legend(frameon=False)
    objects = report["growth"]["objects"]
    right.plot([row["case"] for row in objects], [row["p50_ms"] for row in objects], "o-")
    right.set_xlabel("objects")
    right.set_ylabel("ms per frame (median)")
    right.set_ylim(bottom=0.0)
    right.set_title("growth with objects")
    figure.savefig(path, dpi=150)
