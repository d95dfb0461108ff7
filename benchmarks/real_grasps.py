"""Real reaches to grasp: how early the grip class and the opening show, without any of our models.

``grasp_sizes`` (Ansuini et al. 2015, of the R package PredPsych): a hazelnut or a grapefruit, the
wrist's velocity and height and the aperture at tenths of the movement, people not labelled.
``grasp_depths`` (kinesis, C. Campagnoli): pinch grasps of one person, with both fingers.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TENTHS = range(1, 11)
FOLDS = 5
WRIST = ("Wrist_Velocity", "Wrist_Height")
FINGERS = (*WRIST, "Grip_Aperture")
PARTS = (0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
WITHIN = 0.010  # m


def print_sizes(folder: Path) -> None:
    """Print how often the size, so the grip class, is told by what was seen until each tenth."""
    import pandas as pd

    reaches = pd.read_parquet(folder / "reaches.parquet")
    is_large = reaches["Object.Size"].to_numpy() == 2.0
    print("| part of the movement | wrist alone | wrist and fingers |\n| --- | --- | --- |")
    for tenth in TENTHS:
        cells = []
        for measures in (WRIST, FINGERS):
            names = [f"{m}_{k:02d}" for m in measures for k in range(1, tenth + 1)]
            right = _cross_validated(reaches[names].to_numpy(float), is_large)
            cells.append(f"{100 * right:.1f} %")
        print(f"| {10 * tenth} % | {cells[0]} | {cells[1]} |")


def _cross_validated(inputs: Array, labels: NDArray[np.bool_]) -> float:
    """Return the accuracy of a linear discriminant on rows left out, in interleaved folds."""
    from sklearn.discriminant_analysis import LinearDiscriminantAnalysis

    fold = np.arange(len(labels)) % FOLDS
    right = 0
    for k in range(FOLDS):
        model = LinearDiscriminantAnalysis(solver="lsqr", shrinkage="auto")
        model.fit(inputs[fold != k], labels[fold != k])
        right += int((model.predict(inputs[fold == k]) == labels[fold == k]).sum())
    return right / len(labels)


def print_depths(folder: Path) -> None:
    """Print how near the opening at contact is told at parts of the movement.

    Without the mesh of the object (it is not in the data) the candidates say nothing here: told is
    the mean opening at contact of this person's other reaches for the same depth, and, from the
    fingers, a straight line through aperture and its rate, fitted on the other reaches.
    """
    import pandas as pd

    reaches = pd.read_parquet(folder / "reaches.parquet")
    trials = pd.read_parquet(folder / "trials.parquet")
    end, seen, depth = [], [], []
    for trial in trials.to_dict("records"):
        rows = reaches[reaches["trial"] == trial["trial"]]
        t = rows["t"].to_numpy(float)
        fingers = rows[["index_x", "index_y", "index_z"]].to_numpy(float)
        apertures = np.linalg.norm(
            fingers - rows[["thumb_x", "thumb_y", "thumb_z"]].to_numpy(float), axis=1
        )
        onset, last = float(trial["onset_s"]), float(trial["end_s"])
        whole = np.isfinite(apertures)
        t, apertures = t[whole], apertures[whole]
        times = onset + np.array(PARTS) * (last - onset)
        rates = np.interp(times, t, np.gradient(apertures, t))
        end.append(np.interp(last, t, apertures))
        seen.append(np.stack([np.interp(times, t, apertures), rates * (last - onset)], axis=1))
        depth.append(float(trial["object_depth_m"]))
    at_contact, before, depths = np.array(end), np.array(seen), np.array(depth)
    print(f"{len(depths)} reaches; opening at contact {1e3 * at_contact.min():.0f} to "
          f"{1e3 * at_contact.max():.0f} mm")  # fmt: skip
    print("| part | by the object's depth | aperture as it is | fingers, line | both |")
    print("| --- | --- | --- | --- | --- |")
    by_depth = _left_out(np.stack([depths], axis=1), at_contact)
    for k, part in enumerate(PARTS):
        both = np.column_stack([depths, before[:, k]])
        told = (by_depth, before[:, k, 0], _left_out(before[:, k], at_contact),
                _left_out(both, at_contact))  # fmt: skip
        cells = [f"{100 * float((np.abs(x - at_contact) <= WITHIN).mean()):.1f} %" for x in told]
        print(f"| {part:.0%} | " + " | ".join(cells) + " |")


def _left_out(inputs: Array, outputs: Array) -> Array:
    """Return each output by a straight line fitted on all others."""
    told = np.empty(len(outputs))
    rows = np.column_stack([np.ones(len(outputs)), inputs])
    for k in range(len(outputs)):
        others = np.arange(len(outputs)) != k
        line = np.linalg.lstsq(rows[others], outputs[others], rcond=None)[0]
        told[k] = rows[k] @ line
    return told
