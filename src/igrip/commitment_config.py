"""When a commitment is given: thresholds, durations and distances."""

from __future__ import annotations

from igrip.adaptation import AdaptationConfig
from igrip.settings import Settings, quantity

ALL_HANDS: tuple[str, ...] = ("*",)
MAX_RAISED = 0.98  # no threshold is raised beyond it: it could not be reached


class CommitmentConfig(Settings):
    """How certain and for how long a target must be, and which hands are assisted.

    Attributes
    ----------
    assisted : tuple of str
        Ids of the hands that a device assists; ``("*",)``: every hand. No other ever commits.
    needs_confirmation : bool
        Whether each reach must be confirmed from outside (a switch, a muscle) to be acted on.
    """

    assisted: tuple[str, ...] = ALL_HANDS
    needs_confirmation: bool = False
    reliability: float = quantity(
        0.65, "1", "0: reactive, early and sometimes wrong; 1: reliable, late or not at all",
        "docs/commitment.md", ge=0, le=1,
    )  # fmt: skip
    min_threshold: float = quantity(
        0.5, "1", "confidence required at reliability 0", "guess", gt=0, lt=1
    )
    max_threshold: float = quantity(
        0.98, "1", "confidence required at reliability 1", "guess", gt=0, le=1
    )
    max_dwell: float = quantity(
        0.2, "s", "a target must be likely for this long at reliability 1, at 0 not at all",
        "guess", ge=0,
    )  # fmt: skip
    strange_margin: float = quantity(
        0.15, "1", "the threshold is this much higher in a movement like none that was learned "
        "from, up to 0.98", "docs/commitment.md", ge=0, lt=1,
    )  # fmt: skip
    full_familiarity: float = quantity(
        0.3, "1", "from this familiarity on the threshold is not raised",
        "nine in ten real reaches have more", gt=0, le=1,
    )  # fmt: skip
    adaptation: AdaptationConfig = AdaptationConfig()
    hysteresis: float = quantity(
        0.25, "1", "a target is kept until its confidence falls this much below the threshold",
        "guess", ge=0, lt=1,
    )  # fmt: skip
    lease_duration: float = quantity(
        0.15, "s", "a lease ends this long after the newest measurement of the hand", "guess",
        gt=0,
    )  # fmt: skip
    max_pause: float = quantity(
        0.3, "s", "after a pause no longer than this a lease resumes without a dwell", "guess",
        ge=0,
    )  # fmt: skip
    veto_rest_duration: float = quantity(
        0.3, "s", "a trusted hand must rest this long to end a veto", "guess", ge=0
    )
    max_wait: float = quantity(
        3.0, "s", "a reach for what another hand holds waits at it for this long until it is free",
        "guess", ge=0,
    )  # fmt: skip
    holding_distance: float = quantity(
        0.12, "m", "a palm that stops this near to the surface of its target holds it", "guess",
        gt=0,
    )  # fmt: skip
    release_margin: float = quantity(
        0.06, "m", "a hand releases its target where it is this much further from it", "guess",
        gt=0,
    )  # fmt: skip

    @property
    def threshold(self) -> float:
        """Confidence from which a target is committed to, in a familiar movement."""
        return self.min_threshold + self.reliability * (self.max_threshold - self.min_threshold)

    def threshold_in(self, familiarity: float | None) -> float:
        """Return the confidence from which a target is committed to in a movement.

        Parameters
        ----------
        familiarity : float or None
            Of the movement, from 0 to 1; None: not known.
        """
        if familiarity is None:
            return self.threshold
        strangeness = 1.0 - min(1.0, familiarity / self.full_familiarity)
        raised = min(self.threshold + self.strange_margin * strangeness, MAX_RAISED)
        return max(self.threshold, raised)

    @property
    def dwell(self) -> float:
        """For how long the confidence must be above the threshold [s]."""
        return self.reliability * self.max_dwell

    def assists(self, hand: str) -> bool:
        """Return whether a device assists this hand."""
        return self.assisted == ALL_HANDS or hand in self.assisted
