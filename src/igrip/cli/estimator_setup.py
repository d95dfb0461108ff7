"""What commands do before they run an estimator live: its configuration and the warm-up."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from igrip.commitment import CommitmentConfig
from igrip.config import Config
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.io.config_file import read_config
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.targets import TARGETS


def base_config(file: Path | None, targets: str | None = None) -> Config:
    """Return the configuration of a file, or the library's, with another targets estimator."""
    config = Config() if file is None else read_config(file)
    return config if targets is None else with_targets(config, targets)


def with_targets(config: Config, targets: str) -> Config:
    """Return a configuration with another targets estimator."""
    TARGETS.check(targets)
    return config.model_copy(update={"targets": targets})


def estimator_config(
    targets: str | None,
    assisted: Sequence[str] | None = None,
    reliability: float | None = None,
    confirm: bool = False,
    file: Path | None = None,
) -> Config:
    """Return the configuration of an estimator that these options ask for."""
    config = base_config(file, targets)
    asked: dict[str, Any] = {}
    if assisted:
        asked["assisted"] = tuple(assisted)
    if reliability is not None:
        asked["reliability"] = reliability
    if confirm:
        asked["needs_confirmation"] = True
    commitment = CommitmentConfig(**(config.commitment.model_dump() | asked))
    return config.model_copy(update={"commitment": commitment})


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
