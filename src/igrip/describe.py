"""Descriptions of intentions for people."""

from __future__ import annotations

from typing import NamedTuple

from igrip.intention import Intention

_STATES = {
    "warming_up": "is not followed for long enough yet",
    "idle": "rests",
    "holding": "holds an object",
    "lost": "is lost",
    "invalid": "is not trusted",
}


class Headline(NamedTuple):
    """What a hand does, in a few words, and for which object; ``target`` None: for none."""

    verb: str
    target: str | None


def headline(intention: Intention) -> Headline:
    """Return what a hand does; undecided as long as ``none`` is at least as likely as the target.

    Examples
    --------
    >>> headline(Intention(t=1.0, hand="right", status="reaching", target="bleach",
    ...                    probability={"bleach": 0.02, "none": 0.98}))
    Headline(verb='moves, undecided', target=None)
    """
    if intention.status != "reaching":
        return Headline(_STATES[intention.status], None)
    if intention.target is None or is_undecided(intention):
        return Headline("moves, undecided", None)
    return Headline("reaches for", intention.target)


def is_undecided(intention: Intention) -> bool:
    """Whether no object is likelier than ``none``; False without probabilities."""
    probability = intention.probability
    if probability is None or intention.target is None:
        return False
    return probability.get("none", 0.0) >= probability.get(intention.target, 0.0)


def describe(intention: Intention) -> str:
    """Describe in one sentence what a hand is doing.

    Examples
    --------
    >>> describe(Intention(t=1.0, hand="right", status="reaching", target="mustard",
    ...                    grip="palmar", confidence=0.83, time_to_contact=0.4))
    'right hand reaches for mustard, palmar grip, score 0.83, contact in 0.4 s'
    """
    verb, target = headline(intention)
    sentence = f"{intention.hand} hand {verb}"
    if target is None:
        probability = intention.probability
        if intention.status == "reaching" and probability and intention.target:
            chances = {"none": probability.get("none", 0.0)}
            chances[intention.target] = probability.get(intention.target, 0.0)
            shown = ", ".join(f"{name} {chance:.0%}" for name, chance in chances.items())
            return f"{sentence}: {shown}"
        return f"{sentence}: {intention.reason}" if intention.reason else sentence
    parts = [f"{sentence} {target}", f"{intention.grip} grip"]
    if intention.probability is not None:
        parts.append(f"{intention.probability.get(target, 0.0):.0%} sure")
    elif intention.confidence is not None:
        parts.append(f"score {intention.confidence:.2f}")
    if intention.time_to_contact is not None:
        parts.append(f"contact in {intention.time_to_contact:.1f} s")
    return ", ".join(parts)
