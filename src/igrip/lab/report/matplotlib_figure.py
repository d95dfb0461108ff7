"""Where figures come from: matplotlib, if it is installed."""

from __future__ import annotations

from typing import Any

from igrip.errors import requires_extra


def new_figure(width: float, height: float, purpose: str) -> Any:
    """Return an empty matplotlib figure of a size in inches, bound to no window.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed; ``purpose`` says what needs it.
    """
    with requires_extra("matplotlib", "report", purpose):
        from matplotlib.figure import Figure
    return Figure(figsize=(width, height), layout="constrained")
