"""The evaluation of one trial (paper, "Trial evaluation")."""

from __future__ import annotations


def onset_and_end(times, speeds):
    """Return the times of movement onset and end from one trace of speed."""
    peak = max(range(len(speeds)), key=lambda k: speeds[k])
    onset = next(k for k in range(peak + 1) if speeds[k] > 0.10 * speeds[peak])
    after = speeds[peak + 1 :]
    if not after:
        return times[onset], None
    threshold = min(after) + 0.10 * (speeds[peak] - min(after))
    end = next((k for k in range(peak + 1, len(speeds)) if speeds[k] < threshold), None)
    return times[onset], None if end is None else times[end]


def k_target(correct, k_f):
    """First frame of the longest run of correct frames up to k_f, the earliest if tied."""
    best, length, k = None, 0, 0
    while k <= k_f:
        run = 0
        while k + run <= k_f and correct[k + run]:
            run += 1
        if run > length:
            best, length = k, run
        k += run + 1
    return best


def trial(times, correct, onset, end):
    """Return ratio, success, delay (raw and clipped at onset) and margin of one trial."""
    k_f = max(k for k, t in enumerate(times) if t <= end)
    first = k_target(correct, k_f)
    if first is None:
        return {"ratio": 0.0, "success": False, "delay": None, "clipped": None, "margin": None}
    ratio = sum(correct[first : k_f + 1]) / (k_f + 1 - first)
    delay = times[first] - onset
    return {
        "ratio": ratio,
        "success": ratio > 0.70,
        "delay": delay,
        "clipped": max(0.0, delay),
        "margin": times[k_f] - times[first],
    }
