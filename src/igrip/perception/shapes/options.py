"""Options of the pose estimator ``shapes``."""

from __future__ import annotations

from igrip.settings import Settings, quantity


class ShapesOptions(Settings):
    """The options of the pose estimator ``shapes``.

    Attributes
    ----------
    models : list of str or None
        Not used: what is known is no matter here. Accepted, as every pose estimator is given it.
    names : str or None
        TOML file of names; written at the end if it does not exist.
    """

    models: tuple[str, ...] | None = None
    names: str | None = None
    min_depth: float = quantity(0.2, "m", "of what is looked at", "guess", ge=0)
    max_depth: float = quantity(2.0, "m", "of what is looked at", "guess", gt=0)
    search_interval: float = quantity(
        0.25, "s", "between looks for new things", "docs/unknown-objects.md", ge=0
    )
    steady: float = quantity(
        0.2, "s", "that something new must stand still to be a thing; what goes on beyond the "
        "picture's edge three times as long", "guess", ge=0,
    )  # fmt: skip
    max_misfit: float = quantity(
        0.75, "1", "of the simple shape that explains it best: what fits worse is no thing",
        "docs/unknown-objects.md", gt=0,
    )  # fmt: skip
    refine_step: float = quantity(
        0.05, "1", "by which a size must change for the model to be changed; and its middle, in "
        "shares of its size", "docs/unknown-objects.md", gt=0,
    )  # fmt: skip
    refine_until: float = quantity(
        3.0, "s", "after a thing was first seen its model may change; later only if more of it "
        "becomes visible", "guess", ge=0,
    )  # fmt: skip
    tolerance: float = quantity(
        0.004, "m", "by which cameras err, besides noise", "as of 'depth'", gt=0
    )
    seed: int = quantity(0, "1", "of the random choices", "", ge=0)
