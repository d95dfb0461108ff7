"""The near/far reaches: the layout on made-up tables, and the real data where they are."""

from pathlib import Path

import numpy as np
import pytest

from igrip import Config
from igrip.io.import_dataset import import_dataset
from igrip.io.importers import ImportFiles, find_importer
from igrip.io.resampling import ImportOptions
from igrip.lab.evaluation.replay import replay_run, summarise_replay
from igrip.lab.evaluation.runner import run_trials
from igrip.lab.parallel import Workers
from igrip.objects.catalog import load_objects

pd = pytest.importorskip("pandas", reason="the extra 'tables' is not installed")


def test_layout(tmp_path: Path) -> None:
    trials = pd.DataFrame(
        {
            "trial": [7, 9], "participant": ["sub-1", "sub-2"], "start_pad": ["left", "right"],
            "target": ["left", "left"], "near": [True, False], "block": [1, 2],
            "left_x": 0.1, "left_y": 0.2, "left_z": 0.3, "right_x": 0.4, "right_y": 0.5,
            "right_z": 0.6,
        }
    )  # fmt: skip
    reaches = pd.DataFrame(
        {"trial": [9, 7, 9, 7], "t": [0.0, 0.5, 0.25, 0.0], "x": [9.0, 7.5, 9.25, 7.0], "y": 0.0,
         "z": 0.0}
    )  # fmt: skip
    trials.to_csv(tmp_path / "trials.csv", index=False)
    reaches.to_csv(tmp_path / "reaches.csv", index=False)
    files = ImportFiles([tmp_path])
    importer = find_importer(files)
    first, second = (read() for read in importer.reaches(files))
    assert (first.participant, first.target, first.extra["distance"]) == ("sub-1", "left", "near")
    assert second.extra["distance"] == "far"
    np.testing.assert_array_equal(first.times, [0.0, 0.5])
    np.testing.assert_array_equal(first.positions[:, 0], [7.0, 7.5])
    np.testing.assert_array_equal(second.positions[:, 0], [9.0, 9.25])
    np.testing.assert_array_equal(first.object_positions["right"], [0.4, 0.5, 0.6])


def test_real_reaches_land_near_the_prototype(shared_data: Path, tmp_path: Path) -> None:
    """MEASURED: paper 72 % of trials and 72/70 % at 40/60 %; repaired 76-84 % of trials."""
    files = ImportFiles([shared_data / "wispinski2021"])
    importer = find_importer(files)
    reaches = importer.reaches(files)[::36]
    options = ImportOptions(noise=0.004)
    dataset = import_dataset(
        importer, reaches, tmp_path / "d", load_objects("ycb"), options, ["ycb"]
    )
    assert len(dataset.trials) == 300
    configs = [Config(targets="paper"), Config(targets="repaired")]
    catalog = load_objects(*dataset.objects)
    runs = list(run_trials(dataset, catalog, configs, replay_run, dataset.trials, Workers(2)))
    rows = summarise_replay(dataset, runs)["results"]
    paper, repaired = (row for row in rows if row["group"] == "all")
    assert paper["trials"] == 300
    # 300 trials: a standard error of 2.6 points
    assert 0.68 < paper["success"] < 0.88
    assert 0.76 < repaired["success"] < 0.94
    assert 0.62 < paper["accuracy_40%"] < 0.80
    assert 0.62 < paper["accuracy_60%"] < 0.80
