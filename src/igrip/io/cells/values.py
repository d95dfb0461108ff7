"""Single cells: numbers, what stands for a missing one, and times of day."""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from datetime import datetime

# what programs write where there is no number
MISSING = frozenset({
    "", "na", "n/a", "#n/a", "nan", "-nan", "-nan(ind)", "nan(ind)", "1.#qnan", "-1.#ind", "1.#ind",
    "none", "null", "missing", "-", "--", "—", "?", ".", "inf", "-inf", "infinity", "-infinity",
    "lost", "occluded", "undefined",
})  # fmt: skip
UNKNOWN_TEXTS = frozenset({"", "n/a"})
"""What a cell of texts holds where its text is not known: nothing, or ``n/a`` as in BIDS."""
_DATE = re.compile(r"\d{4}-\d\d-\d\d[T ]\d|\d{8}T\d")
_CLOCK = re.compile(
    r"(?:\d{1,4}[./-]\d{1,2}[./-]\d{1,4}[ T])?"  # a date in any order: only the time counts
    r"(?:(\d{1,3}):)?(\d{1,2}):(\d{1,2}(?:[.,:]\d+)?)\s*([AaPp][Mm])?"
)


def number(text: str, decimal: str = ".", missing: Collection[str] = ()) -> float | None:
    """Return a cell as a number, NaN where it is missing, None where it is anything else.

    Parameters
    ----------
    text : str
        The cell.
    decimal : str
        Decimal mark.
    missing : collection of str
        Further words that stand for a missing number.
    """
    text = text.strip()
    if text.lower() in MISSING or text in missing:
        return math.nan
    if decimal == ",":
        if "." in text:
            return None
        text = text.replace(",", ".")
    if "_" in text:  # Python's own way to group digits
        return None
    try:
        value = float(text)
    except ValueError:
        return None
    if missing and any(value == number(word) for word in missing):
        return math.nan
    return value if math.isfinite(value) else math.nan


def known_text(text: str) -> str | None:
    """Return a cell of texts without the blanks round it; None where its text is not known."""
    text = text.strip()
    return None if text.lower() in UNKNOWN_TEXTS else text


def clock_time(text: str) -> float | None:
    """Return a time of day ``hh:mm:ss.fff`` in seconds; None if it is none.

    The hours may be missing; a date before it is left out, and ``PM`` after it is known.
    """
    match = _CLOCK.fullmatch(text.strip())
    if not match:
        return None
    hours, half = int(match[1] or 0), (match[4] or "").lower()
    if half:
        hours = hours % 12 + (12 if half == "pm" else 0)
    fraction = match[3].replace(",", ".").replace(":", ".")
    return 3600.0 * hours + 60.0 * int(match[2]) + float(fraction)


def date_time(text: str) -> datetime | None:
    """Return a date with a time as in ISO 8601, without its zone; None if it is none."""
    text = text.strip()
    if not _DATE.match(text):
        return None
    try:
        return datetime.fromisoformat(text.replace(",", ".")).replace(tzinfo=None)
    except ValueError:
        return None


def is_time(text: str) -> bool:
    """Return whether a text is a time of day or a date with a time."""
    return clock_time(text) is not None or date_time(text) is not None
