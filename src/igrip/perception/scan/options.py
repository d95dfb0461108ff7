"""Options of a scan."""

from __future__ import annotations

from igrip.settings import Settings, quantity


class ScanOptions(Settings):
    """The numbers of a scan."""

    stand: float = quantity(
        0.0, "m", "height of the turntable under the thing, over the table", "", ge=0, le=0.3
    )
    cell: float = quantity(
        0.002, "m", "edge of the grid's cells; larger for large things", "docs/scan.md", gt=0
    )
    step: float = quantity(
        12.0, "degrees", "by which it must have turned for another view", "docs/scan.md", gt=0
    )
    arc: float = quantity(
        60.0, "degrees", "that one view counts for", "guess: one may turn it so far at a time", gt=0
    )
    settle: float = quantity(
        0.4, "s", "that a thing must stand still, over which its depth is averaged", "guess", gt=0
    )
    patience: float = quantity(
        30.0, "s", "without anything new, after which a scan ends", "guess", gt=0
    )
    min_depth: float = quantity(0.2, "m", "of what is looked at", "guess", ge=0)
    max_depth: float = quantity(1.5, "m", "of what is looked at", "guess", gt=0)
    tolerance: float = quantity(
        0.004, "m", "by which cameras err, besides noise", "as of 'depth'", gt=0
    )
    seed: int = quantity(0, "1", "of the random choices", "", ge=0)
