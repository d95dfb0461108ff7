import numpy as np
import pytest

pytest.importorskip("optuna", reason="the extra 'tune' is not installed")

from igrip.config import Config
from igrip.errors import IgripError
from igrip.lab.tuning.search import PATIENCE, OutcomeTable, Search, open_storage
from igrip.lab.tuning.space import first_candidates
from igrip.lab.tuning.split import folds_of
from tuned_people import PRESENT, QUICK_SPACE, misleading, unsure, work_out

FIRST = first_candidates(Config(), QUICK_SPACE)
COUNT = 10
FOLDS = folds_of([str(k) for k in range(COUNT)], 4, 0)


def search(replays, limit=32, storage=None, stop_after=None, first=FIRST):
    ask, asked = work_out(replays), []

    def outcomes(values):
        if len(asked) == stop_after:
            raise KeyboardInterrupt
        asked.append(values)
        return ask(values)

    table = OutcomeTable(outcomes)
    one = Search("name", table, np.arange(COUNT), FOLDS, QUICK_SPACE, first, 0, limit, storage)
    return one, asked


def test_a_search_that_was_cut_off_continues_as_if_nothing_had_happened(tmp_path):
    replays = unsure(COUNT)
    whole, asked = search(replays)
    assert list(whole.run()) == list(range(1, 33))
    for cut in (5, 28):  # among the first candidates, and among the sampler's
        path = tmp_path / f"{cut}.db"
        first, _ = search(replays, storage=open_storage(path), stop_after=cut)
        with pytest.raises(KeyboardInterrupt):
            list(first.run())
        again, asked_again = search(replays, storage=open_storage(path))
        assert len(again) == len(first) >= cut
        list(again.run())
        assert again.candidates == whole.candidates
        assert again.scores == whole.scores
        assert len(asked_again) == len(asked) - cut  # nothing is worked out twice


def test_a_search_ends_when_nothing_improves():
    one, _ = search(misleading(COUNT), limit=500)
    list(one.run())
    assert len(one) < 500
    best = int(np.argmax(one.scores))
    assert len(one) - 1 - best >= PATIENCE


def test_candidates_lie_on_the_grid_within_the_bounds():
    one, _ = search(unsure(COUNT))
    list(one.run())
    for values in one.candidates:
        for parameter in QUICK_SPACE:
            value = values[parameter.key]
            assert parameter.low <= value <= parameter.high
            steps = (value - parameter.low) / parameter.step
            assert steps == pytest.approx(round(steps), abs=1e-6)


def test_the_present_may_lie_outside_the_bounds():
    strange = PRESENT | {"commitment.max_dwell": 0.7123}
    one, _ = search(unsure(COUNT), first=[strange])
    list(one.run())
    assert one.candidates[0] == strange


def test_another_file_is_refused(tmp_path):
    path = tmp_path / "study.db"
    path.write_text("no data base, but more text than the header of one would have" * 9)
    with pytest.raises(IgripError, match="delete it to start again"):
        open_storage(path)
