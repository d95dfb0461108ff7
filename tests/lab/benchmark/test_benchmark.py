"""The benchmark: entries of every kind agree, splits are fixed, numbers are those of the rows."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from datasets import write_small_dataset
from igrip import Config, Estimator, Observation, load_objects
from igrip.cli.app import app
from igrip.errors import UnknownNameError
from igrip.intention import Commitment, Intention
from igrip.io.datasets.dataset import Trial
from igrip.lab.benchmark import run as run_module
from igrip.lab.benchmark.answers import Answers, EntryError
from igrip.lab.benchmark.entries import parse_entry
from igrip.lab.benchmark.run import run_entry
from igrip.lab.benchmark.score import score_recording
from igrip.lab.benchmark.sets import is_judged, open_set, parse_set
from igrip.lab.benchmark.table import frame_of, markdown, sum_up
from igrip.lab.evaluation.recorded_trial import RecordedTrial
from igrip.lab.parallel import Workers

MODULE = '''
import igrip

class Mine:
    """An entry that is igrip's own estimator under another name."""

    def __init__(self, catalog):
        self.estimator = igrip.Estimator(catalog, igrip.Config(targets="distance"))

    def update(self, observation):
        return [intention.to_dict() for intention in self.estimator.update(observation)]


class Broken:
    answer = {"status": 5}

    def __init__(self, catalog):
        pass

    def update(self, observation):
        said = {"t": observation.t, "hand": "right", "status": "reaching"} | self.answer
        return [said] if self.answer else []


class Typo(Broken):
    answer = {"probabilityy": {}}


class Late(Broken):
    answer = {"t": 0.05}


class Unsure(Broken):
    answer = {"probability": {"mug": 0.9, "none": 0.9}}


class Odd(Broken):
    answer = {"probability": {"mug": float("nan"), "none": 1.0}}


class Silent(Broken):
    answer = {}


class Throws(Broken):
    def update(self, observation):
        raise KeyError("late boom")
'''
LATE = """

class AfterTheTrial(Mine):
    seen = 0

    def update(self, observation):
        AfterTheTrial.seen += 1
        if AfterTheTrial.seen > 12:  # the trial before the benchmark has ten
            raise KeyError("late boom")
        return super().update(observation)
"""
PROGRAM = """
import json, sys
import igrip
from igrip import Observation
catalog = igrip.load_objects("cylinder:0.03x0.12")
estimator = igrip.Estimator(catalog, igrip.Config(targets="distance"))
for line in sys.stdin:
    for intention in estimator.update(Observation.from_dict(json.loads(line))):
        print(json.dumps(intention.to_dict()))
"""


@pytest.fixture
def judged(tmp_path):
    write_small_dataset(tmp_path / "small")
    return open_set("small", tmp_path / "small")


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with an entry in Python and a program."""
    (tmp_path / "my_entry.py").write_text(MODULE)
    (tmp_path / "program.py").write_text(PROGRAM)
    (tmp_path / "wrong_module.py").write_text("def f(:")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    yield tmp_path
    sys.modules.pop("my_entry", None)


def rows_of(text, judged, out):
    catalog = load_objects(*judged.dataset.objects)
    return list(run_entry(parse_entry(text), judged, catalog, out, Workers()))


def test_entries_of_every_kind_give_the_same_numbers(judged, here):
    texts = ("distance", "mine=my_entry:Mine", f"prog=program:{sys.executable} program.py")
    found = [rows_of(text, judged, here) for text in texts]
    plain = [
        [{k: v for k, v in row.items() if k not in ("entry", "ms")} for row in rows]
        for rows in found
    ]
    assert plain[0] == plain[1] == plain[2]
    assert [row["entry"] for row in found[1]] == ["mine", "mine"]
    assert all(row["success"] for row in found[0])


def test_what_is_done_is_not_done_again_unless_the_entry_changed(judged, here, monkeypatch):
    first = rows_of("mine=my_entry:Mine", judged, here)
    path = here / "rows-small=mine.jsonl"
    path.write_text(path.read_text()[:-40])  # cut short
    asked = []
    answer = run_module._answer

    def note(entry, dataset, catalog, trial):
        asked.append(trial.recording)
        return answer(entry, dataset, catalog, trial)

    monkeypatch.setattr(run_module, "_answer", note)
    again = rows_of("mine=my_entry:Mine", judged, here)
    assert [row["success"] for row in again] == [row["success"] for row in first]
    assert asked == [judged.trials[-1].recording]
    assert rows_of("mine=my_entry:Mine", judged, here) == again
    assert len(asked) == 1
    (here / "my_entry.py").write_text(MODULE + "# changed\n")
    rows_of("mine=my_entry:Mine", judged, here)
    assert len(asked) == 1 + len(judged.trials)


@pytest.mark.parametrize(("text", "words"), [
    ("mine=my_entry:Missing", "has no attribute 'Missing'"),
    ("mine=no_such_module:f", "No module named"),
    ("mine=my_entry", "give module:function"),
    ("mine=program:", "needs a command"),
    ("mine=program:'abc", "No closing quotation"),
    ("mine=wrong_module:f", "invalid syntax"),
    ("../x=my_entry:Mine", "letters"),
])  # fmt: skip
def test_a_wrong_entry_is_named(here, text, words):
    with pytest.raises(EntryError, match=words):
        parse_entry(text)


def test_a_misspelt_estimator_gets_a_suggestion():
    with pytest.raises(UnknownNameError, match="bayes"):
        parse_entry("bays")


@pytest.mark.parametrize(("text", "words"), [
    ("broken=my_entry:Broken", "answered what is no intention"),
    ("typo=my_entry:Typo", "'probabilityy', which no intention has .did you mean 'probability'"),
    ("late=my_entry:Late", r"t = 0.05 to an observation at t = "),
    ("unsure=my_entry:Unsure", "with the sum 1.8, not 1"),
    ("odd=my_entry:Odd", "not from 0 to 1"),
    ("silent=my_entry:Silent", "answered nothing"),
    ("throws=my_entry:Throws", r"'late boom'. .my_entry.py, line \d+. in reach0"),
    ("gone=program:./no-such-program", "No such file"),
    (f"bad=program:{sys.executable} -c 'raise ValueError(7)'", r"exit code 1: .*ValueError: 7"),
    (f"text=program:{sys.executable} -c 'print(5)'", "no intention"),
])  # fmt: skip
def test_an_entry_that_fails_is_named(judged, here, text, words):
    with pytest.raises(EntryError, match=words):
        rows_of(text, judged, here)


def test_an_entry_that_fails_is_left_out_of_the_table(judged, here):
    (here / "late.py").write_text(MODULE + LATE)
    command = ["benchmark", f"small={judged.dataset.path}", "--out", "done",
               "--entry", "late=late:AfterTheTrial", "--entry", "distance"]  # fmt: skip
    ended = CliRunner().invoke(app, command)
    sys.modules.pop("late", None)
    assert ended.exit_code != 0
    table = (here / "done" / "table.md").read_text()
    assert "distance" in table
    assert "late" not in table
    assert "left out of the table: late" in str(ended.exception) + ended.output


def test_the_entry_of_the_page_enters_as_it_stands(judged, here):
    page = (Path(__file__).parents[3] / "docs" / "benchmark.md").read_text(encoding="utf-8")
    code = re.search(r"```python\n(.*?)```", page, re.DOTALL)[1]
    assert len(code.strip().splitlines()) <= 20 + 5  # 20 lines beside imports and blank ones
    (here / "my_entry.py").write_text(code)
    rows = rows_of("mine=my_entry:Nearest", judged, here)
    nearest = rows_of("nearest", judged, here)
    assert [row["success"] for row in rows] == [row["success"] for row in nearest]
    assert all(sum(row["calibration_n"]) for row in rows)


def test_numbers_of_numpy_are_numbers(judged, here):
    (here / "my_entry.py").write_text("""
import numpy as np

class Mine:
    def __init__(self, catalog):
        pass

    def update(self, observation):
        yield {"t": np.float64(observation.t), "hand": "right", "status": "reaching",
               "probability": {"mug": np.float32(0.25), "none": np.float64(0.75)}}
""")
    assert len(rows_of("mine=my_entry:Mine", judged, here)) == len(judged.trials)


def test_another_limit_keeps_what_is_done(judged, here, monkeypatch):
    asked = []
    answer = run_module._answer
    monkeypatch.setattr(run_module, "_answer", lambda *a: asked.append(a[-1]) or answer(*a))
    rows_of("distance", judged, here)
    few = judged.spread(1)
    assert len(rows_of("distance", few, here)) == 1
    rows_of("distance", judged, here)
    assert len(asked) == len(judged.trials)


def test_the_same_people_are_judged_for_good():
    people = [f"P{k:02d}" for k in range(100)]
    judged = [name for name in people if is_judged(name)]
    assert 10 < len(judged) < 35
    assert judged[:3] == ["P03", "P06", "P09"]
    assert not is_judged(None)


def recorded(target="cup"):
    trial = Trial("r", "p", "1", hand="right", target=target, onset_s=1.0, end_s=2.0)
    one = RecordedTrial(trial)
    pose = {"model": "m", "position": [0.1, 0.2, 0.3], "orientation": [0, 0, 0, 1]}
    for k in range(91):
        hands = {"right": {"position": [0.001 * k, 0, 0]}}
        one.add(Observation(t=k / 30, hands=hands, objects={"cup": pose}))
    return one


def answers(*leases):
    """Answers every 1/30 s; a lease from a time on, (t, target)."""
    found = []
    for k in range(91):
        t = k / 30
        lease = next(((s, id) for s, id in reversed(leases) if t >= s), None)
        found.append(Intention(
            t=t, hand="right", status="reaching", target="cup" if t > 1.35 else "can",
            commitment=lease and Commitment(
                target=lease[1], grip="palmar", since=lease[0], valid_until=t + 0.1),
        ))  # fmt: skip
    return Answers(found, 0.091)


def test_leases_are_judged_by_the_first_one():
    row = score_recording(recorded(), answers((1.5, "cup"), (1.7, "can")))
    assert (row["committed"], row["lease_right"]) == (True, True)
    assert row["lease_part"] == pytest.approx(0.5)
    assert row["ms"] == pytest.approx(1.0)
    assert not row["right_at_30%"]
    assert row["right_at_40%"]
    late = score_recording(recorded(), answers((2.5, "cup")))
    assert (late["committed"], late["lease_right"]) == (False, None)
    wrong = score_recording(recorded(), answers((1.2, "can"), (1.5, "cup")))
    assert (wrong["committed"], wrong["lease_right"]) == (True, False)


def test_every_lease_without_a_reach_is_false():
    row = score_recording(recorded("none"), answers((0.5, "cup"), (1.7, "can")))
    assert row["false_leases"] == 2
    assert "lease_right" not in row


def test_the_table_has_means_and_intervals():
    rows = []
    for person in range(8):
        for trial in range(4):
            rows.append(score_recording(recorded(), answers((1.5, "cup"))) | {
                "participant": str(person), "success": trial < 3, "set": "s", "entry": "e",
            })  # fmt: skip
    rows += [score_recording(recorded("none"), answers((0.5, "x"))) | {"set": "s", "entry": "e"}]
    [row] = sum_up(frame_of(rows))
    assert (row["reaches"], row["people"], row["excluded"]) == (32, 9, 0)
    assert row["success"] == {"value": 0.75, "low": 0.75, "high": 0.75}
    assert row["lease_right"]["value"] == 1.0
    assert row["false_per_minute"]["value"] == pytest.approx(1 / (3.0 / 60))
    assert row["ece"]["value"] is None  # nobody gave probabilities
    text = markdown([row])
    assert "| 75.0 [75–75] |" in text
    assert all(line.count("|") == text.splitlines()[0].count("|") for line in text.splitlines())


def test_probabilities_are_judged_too(judged, tmp_path):
    rows = rows_of("bayes", judged, tmp_path)
    [row] = sum_up(frame_of(rows))
    catalog = load_objects(*judged.dataset.objects)
    stated = []
    for trial in judged.trials:
        estimator = Estimator(catalog, Config(targets="bayes"))
        for message in judged.dataset.observations(trial):
            for one in estimator.update(message):
                if one.probability and trial.onset_s <= one.t <= trial.end_s:
                    best = max(one.probability, key=one.probability.get)
                    stated.append((one.probability[best], best == trial.target))
    p, right = np.array(stated, dtype=float).T
    bins = np.minimum((10 * p).astype(int), 9)
    gaps = [abs((p - right)[bins == k].sum()) for k in range(10)]
    assert row["ece"]["value"] == pytest.approx(sum(gaps) / len(p))


def test_sets_are_named(tmp_path, judged):
    assert parse_set(f"a={tmp_path / 'small'}") == ("a", tmp_path / "small")
    assert parse_set(str(tmp_path / "small")) == ("small", tmp_path / "small")
    (tmp_path / "files").mkdir()
    assert parse_set(f"grab={tmp_path / 'files'}")[0] == "grab"
    with pytest.raises(UnknownNameError, match="hot3d"):
        parse_set(f"hot3={tmp_path / 'files'}")
    assert len(json.dumps(judged.split)) > 2
