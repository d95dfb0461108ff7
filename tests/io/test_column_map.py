"""Tables of a layout of one's own, read by a map of columns."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from igrip import load_objects
from igrip.errors import DatasetError
from igrip.io.column_map import read_column_map
from igrip.io.import_dataset import import_dataset
from igrip.io.importers import ImportFiles
from igrip.io.mapped_import import ColumnMapImporter
from igrip.io.recordings.jsonl import JsonlReader
from igrip.io.resampling import ImportOptions

MAP = """
name = "Our lab"
unit = "mm"
time_unit = "ms"
[samples]
table = "take*"
trial = "take"
t = "ms"
x = "X"
y = "Y"
z = "Z"
[trials]
table = "list"
trial = "take"
participant = "who"
hand = "=right"
target = "goal"
grip = "how"
[objects.cup]
x = "cup_x"
y = 400.0
z = 50.0
model = "cylinder:0.04x0.1"
[objects.box]
x = -200.0
y = 400.0
z = 50.0
"""


def write(folder, columns=MAP):
    (folder / "map.toml").write_text(columns)
    t = np.arange(0, 2000, 10.0)
    s = np.clip((t - 500) / 1000, 0, 1)
    done = s**3 * (10 - 15 * s + 6 * s * s)
    frames = []
    for take in (1, 2, 3):
        frames.append(pd.DataFrame(
            {"take": take, "ms": t + 7000, "X": 200 * done, "Y": 350 * done, "Z": 40.0}
        ))  # fmt: skip
    lost = pd.concat(frames)
    lost.loc[(lost["take"] == 2) & (lost["ms"] > 7600) & (lost["ms"] < 7700), "X"] = np.nan
    lost.loc[lost["take"] == 3, "X"] = np.nan
    lost.to_csv(folder / "takes.csv", index=False)
    pd.DataFrame(
        {"take": [1, 2, 3, 9], "who": ["a", "b", "b", "b"], "goal": "cup", "how": "palmar",
         "cup_x": 200.0}
    ).to_csv(folder / "list.tsv", sep="\t", index=False)  # fmt: skip
    return folder


def imported(folder, out):
    importer, problems = ColumnMapImporter(read_column_map(folder / "map.toml")), []
    reaches = importer.reaches(ImportFiles([folder]))
    sources = ["ycb", "cylinder:0.04x0.1"]
    options = ImportOptions(rest=1.0)
    steps = []
    dataset = import_dataset(importer, reaches, out, load_objects(*sources), options, sources,
                             problems, on_progress=lambda: steps.append(1))  # fmt: skip
    assert len(steps) == len(reaches)
    return dataset, problems


def test_units_gaps_and_what_is_left_out(tmp_path):
    dataset, problems = imported(write(tmp_path), tmp_path / "out")
    assert [t.trial for t in dataset.trials] == ["1", "2"]
    assert len(problems) == 2
    assert "3" in problems[0]
    assert "times do not increase" in problems[0]
    assert "trial '9' has no samples" in problems[1]
    first, second = dataset.trials
    assert (first.hand, first.target, first.grip, first.participant) == (
        "right", "cup", "palmar", "a",
    )  # fmt: skip
    assert first.onset_s is None  # the samples hold rest as well: left to the evaluation
    messages = list(JsonlReader(dataset.recording(first)))
    assert messages[0].t == 0.0
    assert messages[-1].hands["right"].position == pytest.approx((0.2, 0.35, 0.04), abs=1e-6)
    cup = messages[0].objects["cup"]
    assert cup.model == "cylinder:0.04x0.1"
    assert cup.position == pytest.approx((0.2, 0.4, 0.05), abs=1e-6)
    assert messages[0].objects["box"].model == "006_mustard_bottle"
    lost = [m.t for m in JsonlReader(dataset.recording(second)) if m.hands["right"] is None]
    assert lost == pytest.approx([0.6333, 0.6667], abs=1e-3)  # 0.61 to 0.69 s were not measured


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('unit = "mm"', 'unit = "inch"', "unit"),
        ('x = "X"', 'x = "W"', "no column 'W'"),
        ('table = "list"', 'table = "nothing"', "no table 'nothing'"),
        ("[objects.cup]", "[object.cup]", "object"),
        ("y = 400.0", "y = [4]", r"objects\.cup\.y"),
        ('name = "Our lab"', "name = ", "Invalid value"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, old, new, words):
    with pytest.raises(DatasetError, match=words):
        imported(write(tmp_path, MAP.replace(old, new)), tmp_path / "out")


def test_a_missing_column_of_the_trials_leaves_each_out_by_name(tmp_path):
    folder = write(tmp_path, MAP.replace('"who"', '"whom"'))
    importer, problems = ColumnMapImporter(read_column_map(folder / "map.toml")), []
    reaches = importer.reaches(ImportFiles([folder]))
    with pytest.raises(DatasetError, match=r"nothing could be imported: .*no column 'whom'"):
        import_dataset(importer, reaches, tmp_path / "out", load_objects("ycb"), ImportOptions(),
                       ["ycb"], problems)  # fmt: skip
    assert all("no column 'whom'" in p for p in problems[:2])
    assert not (tmp_path / "out").exists()


def test_one_table_a_trial(tmp_path):
    write(tmp_path, MAP.replace('trial = "take"\nt =', "t =").replace("take*", "[0-9]*"))
    table = pd.read_csv(tmp_path / "takes.csv")
    (tmp_path / "takes.csv").unlink()
    table[table["take"] == 1].to_parquet(tmp_path / "1.parquet")
    dataset, problems = imported(tmp_path, tmp_path / "out")
    assert [t.trial for t in dataset.trials] == ["1"]
    assert len(problems) == 3


def test_files_named_01_and_rows_without_a_number(tmp_path):
    write(tmp_path, MAP.replace('trial = "take"\nt =', "t =").replace("take*", "[0-9]*"))
    table = pd.read_csv(tmp_path / "takes.csv")
    (tmp_path / "takes.csv").unlink()
    table[table["take"] == 1].to_csv(tmp_path / "01.csv", index=False)
    table[table["take"] == 1].to_csv(tmp_path / "77.csv", index=False)
    rows = pd.DataFrame(
        {"take": ["01", "02"], "who": ["a", None], "goal": ["cup", None], "how": ["Palmar", "x"],
         "cup_x": 200.0}
    )  # fmt: skip
    rows.to_csv(tmp_path / "list.tsv", sep="\t", index=False)
    dataset, problems = imported(tmp_path, tmp_path / "out")
    [trial] = dataset.trials
    assert (trial.trial, trial.grip) == ("1", "palmar")
    assert any("trial '77' has samples, but no row" in p for p in problems)
    assert len(problems) == 2


def test_a_trial_in_two_tables_is_refused(tmp_path):
    write(tmp_path)
    (tmp_path / "takes_again.csv").write_bytes((tmp_path / "takes.csv").read_bytes())
    with pytest.raises(DatasetError, match="is in two tables"):
        imported(tmp_path, tmp_path / "out")


def test_the_map_in_the_documentation_is_valid(tmp_path):
    text = (Path(__file__).parents[2] / "docs" / "importing.md").read_text()
    (tmp_path / "map.toml").write_text(text.split("```toml\n")[1].split("```")[0])
    columns = read_column_map(tmp_path / "map.toml")
    assert columns.declared.missing == ("lost", "-1.0")
    assert columns.objects["mug"].body == "Mug"
