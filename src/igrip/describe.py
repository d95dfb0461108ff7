"""Descriptions of intentions for people."""

from __future__ import annotations

from igrip.intention import Intention

_STATES = {
    "warming_up": "is not followed for long enough yet",
    "idle": "rests",
    "reaching": "reaches",
    "holding": "holds",
    "lost": "is lost",
    "invalid": "is not believed",
}


def describe(intention: Intention) -> str:
    """Describe in one sentence what a hand is doing.

    Examples
    --------
    >>> describe(Intention(t=1.0, hand="right", status="reaching", target="mustard",
    ...                    grip="palmar", confidence=0.83, time_to_contact=0.4))
    'right hand reaches for mustard, palmar grip, score 0.83, contact in 0.4 s'
    """
    state = f"{intention.hand} hand {_STATES[intention.status]}"
    if intention.target is None:
        return f"{state}: {intention.reason}" if intention.reason else f"{state}, no target"
    if intention.status != "reaching":
        return f"{state}; nearest guess {intention.target}, {intention.grip} grip"
    parts = [f"{state} for {intention.target}", f"{intention.grip} grip"]
    if intention.probability is not None:
        parts.append(f"{intention.probability.get(intention.target, 0.0):.0%} sure")
    elif intention.confidence is not None:
        parts.append(f"score {intention.confidence:.2f}")
    if intention.time_to_contact is not None:
        parts.append(f"contact in {intention.time_to_contact:.1f} s")
    return ", ".join(parts)
