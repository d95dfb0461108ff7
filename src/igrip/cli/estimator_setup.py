"""What commands do before they run an estimator live: its configuration and the warm-up."""

from __future__ import annotations

from collections.abc import Sequence

from igrip.commitment import ALL_HANDS, CommitmentConfig
from igrip.config import Config
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.objects.catalog import Catalog
from igrip.observation import Observation

RELIABILITY = CommitmentConfig().reliability


def estimator_config(
    targets: str | None,
    assisted: Sequence[str] | None = None,
    reliability: float = RELIABILITY,
    confirm: bool = False,
) -> Config:
    """Return the configuration of an estimator that these options ask for."""
    commitment = CommitmentConfig(
        assisted=tuple(assisted) if assisted else ALL_HANDS, reliability=reliability,
        needs_confirmation=confirm,
    )  # fmt: skip
    return Config(commitment=commitment, targets=targets or Config().targets)


def warm_up(config: Config, catalog: Catalog) -> None:
    """Compile all that an estimator runs, on a scene of one hand and one object."""
    model = next(iter(catalog), None)
    if model is None:
        raise IgripError("there are no objects to look for (--objects)")
    pose = {"model": model, "position": [0.0, 0.4, 0.0], "orientation": [0.0, 0.0, 0.0, 1.0]}
    estimator = Estimator(catalog, config)
    for k in range(12):
        hands = {"right": {"position": [0.0, 0.02 * k, 0.0]}}
        estimator.update(Observation(t=k / 30.0, hands=hands, objects={"warm-up": pose}))
