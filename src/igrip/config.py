"""Every number a user may change, composed of the frozen configurations of the modules."""

from __future__ import annotations

from pydantic import Field

from igrip.commitment import CommitmentConfig
from igrip.cues import CueConfig
from igrip.gating import GatingConfig
from igrip.geometry.scene import RayConfig
from igrip.grips import GripConfig
from igrip.motion.trajectory import MotionConfig
from igrip.objects.object_track import ObjectConfig
from igrip.settings import Settings
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
