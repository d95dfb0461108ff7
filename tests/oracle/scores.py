"""Confidences, weights, target and grip (paper: Eqs. 2-12, corrected: docs/decisions/0013)."""

from __future__ import annotations

import numpy as np

METRICS = ("impacts", "distance_derivative", "distance", "future_distance")


def impacts(hits):
    """n_j / sum n; 0 for all where nothing is met."""
    hits = np.asarray(hits, dtype=float)
    return hits / hits.sum() if hits.sum() > 0 else np.zeros_like(hits)


def distance_derivative(rates, speed, min_speed=0.03):
    """-d'/v; 0 below a least speed."""
    rates = np.asarray(rates, dtype=float)
    return np.zeros_like(rates) if speed < min_speed else -rates / speed


def closeness(distances, centres, default_spread=0.5):
    """1 - min(d / d_max, 1), d_max the largest distance between two centres."""
    centres = np.asarray(centres, dtype=float)
    d_max = max(
        (np.linalg.norm(a - b) for i, a in enumerate(centres) for b in centres[:i]), default=0.0
    )
    d_max = d_max if d_max > 1e-6 else default_spread
    return 1.0 - np.minimum(np.asarray(distances, dtype=float) / d_max, 1.0)


def weights(kind, speed, peak):
    """Return w_0 and w_1 of ``paper`` or ``repaired``; ``peak`` is None without earlier samples."""
    if peak is None or (speed == 0.0 and peak == 0.0):
        return 1.0, 1.0
    if kind == "paper":
        return speed / max(speed, peak), 2.0 if speed > peak else 1.0
    return 1.0, 2.0 if peak == 0.0 else min(speed / peak, 2.0)


def combined(kind, scores, speed, peak):
    """c_glob = sum w c / sum w; w_0 for the distances, w_1 for impacts and derivative."""
    w0, w1 = weights(kind, speed, peak)
    total = w1 * (scores["impacts"] + scores["distance_derivative"])
    total = total + w0 * (scores["distance"] + scores["future_distance"])
    return total / (2.0 * w0 + 2.0 * w1)


def target(scores, tie=1e-12):
    """Index of the best score; None where it is not positive or shared."""
    scores = list(scores)
    if not scores or not max(scores) > 0.0:
        return None
    best = [k for k, score in enumerate(scores) if score >= max(scores) - tie]
    return best[0] if len(best) == 1 else None


def grip(axial, length):
    """pinch from 0.85 of the half-length on, else palmar."""
    return "pinch" if abs(axial) >= 0.85 * 0.5 * length else "palmar"
