"""What igrip says during a trial, as a device would have got it: recorded beside what was seen."""

from __future__ import annotations

from igrip.config import Config
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.experiment.study import Study
from igrip.intention import Intention
from igrip.objects.catalog import Catalog
from igrip.observation import Observation


class LivePredictions:
    """The estimator of one camera; a recording never fails because of it.

    Parameters
    ----------
    study : Study
        Names the estimator in ``predictions``; without one there are no predictions.
    catalog : Catalog, optional
        With the study's models; without it there are none either.

    Raises
    ------
    UnknownNameError
        If there is no such estimator.
    """

    def __init__(self, study: Study, catalog: Catalog | None) -> None:
        self._catalog = catalog
        self._config = None if study.predictions is None else Config(targets=study.predictions)
        self._estimator: Estimator | None = None
        self.begin_anew()

    def begin_anew(self) -> None:
        """Forget what was seen: the next observation is of another recording."""
        if self._config is not None and self._catalog is not None:
            self._estimator = Estimator(self._catalog, self._config)

    def of(self, observation: Observation) -> list[Intention]:
        """Return the intentions after an observation; none where it contradicts earlier ones."""
        if self._estimator is None:
            return []
        try:
            return self._estimator.update(observation)
        except IgripError:  # time went back, or an id changed its model
            self.begin_anew()
            return []
