"""Compilation before the first message."""

from __future__ import annotations

from igrip.config import Config
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.objects.catalog import Catalog
from igrip.observation import Observation


def warm_up(config: Config, catalog: Catalog) -> None:
    """Compile all that an estimator runs, on a scene of one hand and one object.

    Raises
    ------
    IgripError
        If the catalogue is empty.
    """
    model = next(iter(catalog), None)
    if model is None:
        raise IgripError("there are no objects to look for (--objects)")
    pose = {"model": model, "position": [0.0, 0.4, 0.0], "orientation": [0.0, 0.0, 0.0, 1.0]}
    estimator = Estimator(catalog, config)
    for k in range(12):
        hands = {"right": {"position": [0.0, 0.02 * k, 0.0]}}
        estimator.update(Observation(t=k / 30.0, hands=hands, objects={"warm-up": pose}))
