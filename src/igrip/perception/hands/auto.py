"""``auto``: every detector that this machine and camera allow, each hand by all that see it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from igrip.errors import IgripError, MissingExtraError
from igrip.perception.hands import HANDS, HandDetection, HandDetector, new_detector
from igrip.perception.hands._fusion import fuse
from igrip.perception.hands._palms import measure_palm
from igrip.perception.options import validated
from igrip.rgbd import RgbdFrame
from igrip.settings import Settings


class AutoOptions(Settings):
    """The options of the hand detector ``auto``.

    Attributes
    ----------
    members : sequence of str
        Detectors that are asked, those with landmarks first.
    tags : str, mapping or None
        As for the detector ``tags``, which is asked first if this is given.
    """

    members: tuple[str, ...] = ("mediapipe", "depth")
    tags: str | dict[str, Any] | None = None


@HANDS.register("auto")
class AutoHands:
    """The hands of several detectors, fused by their own uncertainties.

    A hand's ``source`` names the detectors that saw it, the surest first. ``options`` are the
    fields of :class:`AutoOptions`.

    Attributes
    ----------
    problem : str or None
        What keeps some of the detectors from seeing hands just now.

    Raises
    ------
    IgripError
        If no detector can be used, or the options are wrong.
    """

    def __init__(self, options: Mapping[str, Any] | None = None) -> None:
        asked = validated(AutoOptions, "hands auto", options)
        self._members: list[tuple[str, HandDetector]] = []
        self._missing: list[str] = []
        if asked.tags is not None:
            self._members.append(("tags", new_detector("tags", {"tags": asked.tags})))
        for name in asked.members:
            HANDS.check(name)
            try:
                self._members.append((name, new_detector(name)))
            except MissingExtraError as error:
                self._missing.append(f"hands without {name!r}: {error}")
        if not self._members:
            raise IgripError("; ".join(self._missing) or "hands auto: there are no members")
        self.problem: str | None = "; ".join(self._missing) or None

    def detect(self, frame: RgbdFrame) -> list[HandDetection]:
        """Return the hands in a frame, the surest first; each is measured."""
        problems = list(self._missing)
        groups = []
        for name, member in self._members:
            if frame.depth is None and getattr(member, "needs_depth", False):
                continue
            found = []
            for hand in member.detect(frame):
                palm = measure_palm(hand, frame)
                found.append(hand._replace(measured=palm))
            groups.append((name, found))
            problem = getattr(member, "problem", None)
            if problem:
                problems.append(problem)
        self.problem = "; ".join(problems) or None
        measured = [(name, [hand for hand in found if hand.measured]) for name, found in groups]
        # those without depth still cover what is behind them
        rest = [hand for _, found in groups for hand in found if not hand.measured]
        return fuse(measured, frame.camera) + rest

    def close(self) -> None:
        """Close all members."""
        for _, member in self._members:
            member.close()
