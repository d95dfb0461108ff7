"""Tuning by nested cross-validation: inner folds choose, outer folds judge.

For each outer fold a search sees the other trials only; what it finds is then judged on that fold.
So the gain over the present configuration is measured on trials that the choice has not seen. A
last search over all trials finds what is shipped, if that gain is one.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from igrip.errors import IgripError
from igrip.lab.evaluation.calibration import interval_over_groups
from igrip.lab.tuning.objective import trial_values
from igrip.lab.tuning.outcomes import Outcomes
from igrip.lab.tuning.search import OutcomeTable, Search
from igrip.lab.tuning.space import Parameter
from igrip.lab.tuning.split import INNER, OUTER, folds_of

MIN_REACHES = 8
MIN_PEOPLE = 3  # of a cohort: one is left out, and the others differ
MAX_LOSS = 0.01  # share of trials that may be worse than with the present configuration


class Fold(NamedTuple):
    """An outer fold: its trials, and the numbers that the other trials chose."""

    trials: list[int]
    values: dict[str, float]


class Decision(NamedTuple):
    """What came of tuning.

    Attributes
    ----------
    values : mapping of str to float
        The numbers to use.
    tuned : bool
        Whether they differ from the present ones.
    reason : str
        Why, as a sentence.
    found : mapping of str to float
        The best on all trials, whether or not they are used.
    folds : list of Fold
        The outer folds.
    gain : float
        Mean gain in value on trials that the choice has not seen.
    interval : (float, float)
        95 % interval of it, by bootstrap over trials, or over the people of a cohort.
    present, judged : Outcomes
        Of all trials: at present; each with the numbers that the other folds chose.
    """

    values: dict[str, float]
    tuned: bool
    reason: str
    found: dict[str, float]
    folds: list[Fold]
    gain: float
    interval: tuple[float, float]
    present: Outcomes
    judged: Outcomes


class Tuning:
    """Searches for the numbers of a person, or of a cohort.

    Parameters
    ----------
    work_out : callable
        Returns the outcomes of all trials for some numbers.
    groups : sequence of str, n
        What a trial belongs to, and never leaves in a split: itself, or its participant.
    space : sequence of Parameter
        What is tuned.
    first : sequence of mappings
        Candidates that each search begins with; the first one is the present configuration.
    seed, limit : int
        Of splits and samplers; candidates of each search.
    cohort : bool
        Whether groups are people: each is left out once.
    name : str
        Stands for all that outcomes depend on; the studies in the storage begin with it.
    storage : optuna storage, optional
        Where finished candidates are kept.

    Raises
    ------
    IgripError
        If there are too few reaches, or too few people for a cohort.
    """

    def __init__(
        self, work_out: Callable[[Mapping[str, float]], Outcomes], groups: Sequence[str],
        space: Sequence[Parameter], first: Sequence[Mapping[str, float]], *, seed: int = 0,
        limit: int = 100, cohort: bool = False, name: str = "", storage: Any = None,
    ) -> None:  # fmt: skip
        self._groups, self._seed, self._cohort = np.asarray(groups), seed, cohort
        self._first = first
        self.table = OutcomeTable(work_out)
        reaches = int(self.table[first[0]].reaches.sum())
        if reaches < MIN_REACHES:
            raise IgripError(f"tuning needs at least {MIN_REACHES} reaches, there are {reaches}")
        if cohort and len(set(groups)) < MIN_PEOPLE:
            raise IgripError(f"a cohort needs at least {MIN_PEOPLE} people")
        count = len(set(groups)) if cohort else OUTER
        self._outer = folds_of(groups, count, seed)
        every = np.arange(len(groups))
        parts = [every[self._outer != k] for k in np.unique(self._outer)] + [every]
        self.searches = [
            Search(
                f"{name}/{seed}/{k}", self.table, part, self._inner(part), space, first,
                seed + k, limit, storage,
            )
            for k, part in enumerate(parts)
        ]  # fmt: skip

    def _inner(self, part: Any) -> Any:
        groups = self._groups[part].tolist()
        return folds_of(groups, len(set(groups)) if self._cohort else INNER, self._seed + 1)

    def run(self, timeout_s: float | None = None) -> Iterator[int]:
        """Run all searches; yield how many candidates are done after each.

        With a timeout, each search gets an equal share of what is left; what is found then depends
        on the machine.
        """
        begin = time.monotonic()
        done = sum(map(len, self.searches))
        yield done
        for k, search in enumerate(self.searches):
            now = time.monotonic()
            left = None if timeout_s is None else begin + timeout_s - now
            until = None if left is None else now + max(0.0, left) / (len(self.searches) - k)
            for _ in search.run():
                done += 1
                yield done
                if until is not None and time.monotonic() > until:
                    break

    @property
    def is_complete(self) -> bool:
        """Whether every search is over, and none was cut short."""
        return all(search.is_over for search in self.searches)

    def decide(self) -> Decision:
        """Return what to use. Every search must have tried the present configuration."""
        present = self.table[self._first[0]]
        folds, judged = [], [np.array(column) for column in present]
        for k, search in zip(np.unique(self._outer), self.searches[:-1], strict=True):
            own = np.flatnonzero(self._outer == k)
            folds.append(Fold(own.tolist(), search.best))
            for column, better in zip(judged, self.table[search.best], strict=True):
                column[own] = better[own]
        unseen = Outcomes(*judged)
        gains = trial_values(unseen) - trial_values(present)
        low, high = interval_over_groups(gains, self._groups) if gains.any() else (0.0, 0.0)
        now, found = dict(self._first[0]), self.searches[-1].best
        problem = self._objection(present, unseen, low, found)
        return Decision(
            values=now if problem else found, tuned=not problem,
            reason=problem or "the gain on unseen trials is above zero, and nothing is lost",
            found=found, folds=folds, gain=float(gains.mean()), interval=(low, high),
            present=present, judged=unseen,
        )  # fmt: skip

    def _objection(
        self, present: Outcomes, unseen: Outcomes, low: float, found: Mapping[str, float]
    ) -> str | None:
        """Return why the present configuration is kept; None: it is not."""
        if found == dict(self._first[0]):
            return "nothing better was found"
        if not low > 0.0:
            return "the interval of the gain on unseen trials does not exclude zero"
        for outcomes, which in ((unseen, "on unseen trials"), (self.table[found], "on all trials")):
            if outcomes.wrong().mean() > present.wrong().mean() + MAX_LOSS + 1e-9:
                return f"{which} more commitments are wrong"
            right = np.nan_to_num(outcomes.right).mean()
            if right < np.nan_to_num(present.right).mean() - MAX_LOSS - 1e-9:
                return f"{which} fewer reaches get a right commitment"
        return None
