"""Names of columns and bodies: found by their parts, and near misses named."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence

TRIALS = frozenset({
    "trial", "take", "reach", "recording", "repetition", "rep", "trialid", "trialnumber", "trialno",
    "takeid", "reachid",
})  # fmt: skip
"""What a column is called that holds the same value in all rows of one trial; see `plain`."""
PEOPLE = frozenset({
    "participant", "subject", "person", "session", "run", "block", "participantid", "subjectid",
})  # fmt: skip
"""What a column is called that says whose trials these are, or when."""


def plain(name: str) -> str:
    """Return a name in lower case, without blanks, hyphens and underscores."""
    return "".join(part for part in name.lower() if part not in " _-")


def trial_column(columns: Iterable[str]) -> str | None:
    """Return the column that separates trials, by its name."""
    return next((name for name in columns if plain(name) in TRIALS), None)


def near_miss(name: str, names: Iterable[str]) -> str:
    """Return "; did you mean …?" where a name is much like some others, else nothing."""
    choices = {other.lower(): other for other in names}
    close = difflib.get_close_matches(name.lower(), choices, n=1, cutoff=0.75)
    return f"; did you mean {choices[close[0]]!r}?" if close else ""


def fitting_columns(address: str, paths: Sequence[Sequence[str]]) -> list[int]:
    """Return the columns that an address fits, by the names in the rows of the header."""
    for joined in "/ _:.":  # as a header with one row writes them
        exact = [k for k, path in enumerate(paths) if joined.join(path) == address]
        if exact:
            return exact
    wanted = address.split("/")
    return [
        k for k, path in enumerate(paths)
        if path and path[-1] == wanted[-1] and _in_order(wanted, path)
    ]  # fmt: skip


def _in_order(wanted: Sequence[str], path: Sequence[str]) -> bool:
    parts = iter(path)
    return all(any(part == want for part in parts) for want in wanted)


def shortened(names: Sequence[str], limit: int = 12) -> str:
    """Return names as a list of which only the first are written."""
    more = f", … ({len(names)} in all)" if len(names) > limit else ""
    return ", ".join(names[:limit]) + more
