"""One search for the best numbers: an Optuna study that is kept in SQLite as it grows.

The sampler is the tree-structured Parzen estimator (Bergstra et al. 2011, NeurIPS 24). Its seed
follows from the number of the candidate, and what is stored is a finished candidate as a whole: a
search that was cut off at any time continues as if nothing had happened.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from igrip.errors import IgripError, requires_extra
from igrip.lab.tuning.objective import score
from igrip.lab.tuning.outcomes import Outcomes
from igrip.lab.tuning.space import Parameter

if TYPE_CHECKING:
    import optuna

PATIENCE = 30  # candidates without a better one end a search
DIGITS = 9  # of a number: 0.57, not 0.5700000000000001
STARTUP = 24  # candidates before the sampler models what it has seen

Numbers = tuple[tuple[str, float], ...]
"""Tuned numbers in a fixed order, to look outcomes up by."""


class OutcomeTable:
    """The outcomes of all trials by numbers, worked out once."""

    def __init__(self, work_out: Callable[[Mapping[str, float]], Outcomes]) -> None:
        self._work_out = work_out
        self.known: dict[Numbers, Outcomes] = {}

    def __getitem__(self, values: Mapping[str, float]) -> Outcomes:
        """Return the outcomes of one candidate."""
        key = numbers(values)
        if key not in self.known:
            self.known[key] = self._work_out(values)
        return self.known[key]


def numbers(values: Mapping[str, float]) -> Numbers:
    """Return numbers in a fixed order."""
    return tuple(sorted((key, float(value)) for key, value in values.items()))


class Search:
    """A search for the numbers with the highest score on some of the trials.

    Parameters
    ----------
    name : str
        Of the study in the storage: it stands for all that the result depends on.
    table : OutcomeTable
        Outcomes of all trials.
    trials : (m,)
        Indices of those that the score may see.
    folds : (m,)
        Their inner folds.
    space, first : sequences
        What is tuned, and the candidates to begin with; the first one is the present.
    seed, limit : int
        Of the sampler; the number of candidates.
    storage : optuna storage, optional
        Where finished candidates are kept (:func:`open_storage`).
    """

    def __init__(
        self, name: str, table: OutcomeTable, trials: NDArray[np.intp], folds: NDArray[np.intp],
        space: Sequence[Parameter], first: Sequence[Mapping[str, float]], seed: int, limit: int,
        storage: Any = None,
    ) -> None:  # fmt: skip
        with requires_extra("optuna", "tune", "tuning"):
            import optuna
        self._optuna = optuna
        self._table, self._chosen, self._folds = table, trials, folds
        self._first, self._seed, self._limit = first, seed, limit
        self._space = {
            p.key: optuna.distributions.FloatDistribution(p.low, p.high, step=p.step) for p in space
        }
        self._done: list[optuna.trial.FrozenTrial] = []
        self._kept: optuna.Study | None = None
        if storage is not None:
            self._kept = optuna.create_study(
                storage=storage, study_name=name, direction="maximize", load_if_exists=True
            )
            self._done = self._kept.trials[:limit]
        for trial in self._done:
            outcomes = _from_json(trial.user_attrs["outcomes"])
            table.known.setdefault(numbers(trial.user_attrs["values"]), outcomes)

    def __len__(self) -> int:
        """Return how many candidates are done."""
        return len(self._done)

    @property
    def candidates(self) -> list[dict[str, float]]:
        """The numbers of those that are done, in order."""
        return [dict(trial.user_attrs["values"]) for trial in self._done]

    @property
    def scores(self) -> list[float]:
        """Their scores."""
        return [float(trial.value or 0.0) for trial in self._done]

    @property
    def best(self) -> dict[str, float]:
        """The numbers with the highest score; of equals those that came first."""
        return self.candidates[int(np.argmax(self.scores))]

    @property
    def is_over(self) -> bool:
        """Whether there were enough candidates, or nothing improves any more."""
        begun = max(STARTUP, len(self._first))
        if len(self) < min(begun, self._limit):
            return False
        last = max(int(np.argmax(self.scores)), begun - 1)
        return len(self) >= self._limit or len(self) - 1 - last >= PATIENCE

    def run(self) -> Iterator[int]:
        """Try candidates until the search is over; yield how many are done after each."""
        while not self.is_over:
            self._try_next()
            yield len(self)

    def _try_next(self) -> None:
        number = len(self)
        values = dict(self._first[number]) if number < len(self._first) else self._ask()
        outcomes = self._table[values]
        trial = self._optuna.trial.create_trial(
            params={key: _on_grid(values[key], one) for key, one in self._space.items()},
            distributions=dict(self._space),
            value=score(outcomes.take(self._chosen), self._folds),
            user_attrs={"values": values, "outcomes": _to_json(outcomes)},
        )
        if self._kept is not None:
            self._kept.add_trial(trial)
        self._done.append(trial)

    def _ask(self) -> dict[str, float]:
        """Return what the sampler proposes after all that is done."""
        [seed] = np.random.SeedSequence([self._seed, len(self)]).generate_state(1)
        sampler = self._optuna.samplers.TPESampler(
            seed=int(seed), n_startup_trials=STARTUP, multivariate=True
        )
        study = self._optuna.create_study(direction="maximize", sampler=sampler)
        study.add_trials(self._done)
        asked = study.ask(dict(self._space)).params
        return {key: round(float(value), DIGITS) for key, value in asked.items()}


def open_storage(path: Path) -> Any:
    """Open the file of the studies, which is made where there is none.

    Raises
    ------
    IgripError
        If it cannot be written, or holds something else.
    MissingExtraError
        If Optuna is not installed.
    """
    with requires_extra("optuna", "tune", "tuning"):
        import optuna
        from sqlalchemy.exc import SQLAlchemyError
    silence()
    try:
        return optuna.storages.RDBStorage(f"sqlite:///{path}")
    except (SQLAlchemyError, RuntimeError) as error:
        problem = str(error).splitlines()[0]
        raise IgripError(f"{path}: {problem}; delete it to start again") from error


def silence() -> None:
    """Let Optuna report no more than warnings: the commands show their own progress."""
    with requires_extra("optuna", "tune", "tuning"):
        import optuna
    optuna.logging.set_verbosity(optuna.logging.WARNING)


def _on_grid(value: float, distribution: Any) -> float:
    """Return the nearest value of a distribution: what is set at present may lie between two."""
    low, high, step = distribution.low, distribution.high, distribution.step
    return float(low + step * round((min(max(value, low), high) - low) / step))


def _to_json(outcomes: Outcomes) -> list[list[float | None]]:
    return [[None if math.isnan(x) else x for x in column.tolist()] for column in outcomes]


def _from_json(columns: Sequence[Sequence[float | None]]) -> Outcomes:
    return Outcomes(*(np.array(column, dtype=np.float64) for column in columns))
