"""Every number a user may change, composed of the frozen configurations of the modules."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from igrip.commitment import CommitmentConfig
from igrip.cues import CueConfig
from igrip.gating import GatingConfig
from igrip.geometry.scene import RayConfig
from igrip.grips import GRIPS, GripConfig
from igrip.motion.trajectory import MotionConfig
from igrip.objects.object_track import ObjectConfig
from igrip.settings import Settings
from igrip.targets import TARGETS
from igrip.tracking import TrackingConfig


class Config(Settings):
    """Configuration of an estimator: immutable, and checked when it is made.

    Attributes
    ----------
    targets : str
        Name of the targets estimator. The default is the one with the highest mean causal accuracy
        at 40 and 60 % of the movement on real near/far reaches (README, "Real reaches").
    grips : str
        Name of the grip selector; ``contact`` is the paper's ``cylinder`` for targets estimators
        without a posterior.
    motion, objects, rays, cues, grip, commitment, gating, tracking
        Configurations of the stages, see there.

    Raises
    ------
    UnknownNameError
        If there is no such targets estimator or grip selector.
    pydantic.ValidationError
        If a key is unknown or a value out of bounds.

    Examples
    --------
    >>> Config(targets="paper", cues={"distance": "surface"}).cues.distance
    'surface'
    """

    targets: str = "bayes"
    grips: str = "contact"
    motion: MotionConfig = Field(default=MotionConfig())
    objects: ObjectConfig = Field(default=ObjectConfig())
    rays: RayConfig = Field(default=RayConfig())
    cues: CueConfig = Field(default=CueConfig())
    grip: GripConfig = Field(default=GripConfig())
    commitment: CommitmentConfig = Field(default=CommitmentConfig())
    gating: GatingConfig = Field(default=GatingConfig())
    tracking: TrackingConfig = Field(default=TrackingConfig())

    if not TYPE_CHECKING:  # type checkers derive the arguments from the fields

        def __init__(self, **values: Any) -> None:
            super().__init__(**values)
            # not by a validator: pydantic would turn an UnknownNameError into its own error
            TARGETS.check(self.targets)
            GRIPS.check(self.grips)
