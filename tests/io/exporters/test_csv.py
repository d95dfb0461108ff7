"""Plain tables: pandas reads what was recorded."""

import numpy as np
import pandas as pd

from datasets import write_small_dataset
from igrip.io.exporters import EXPORTERS


def test_tables_hold_trials_and_recordings(tmp_path):
    dataset = write_small_dataset(tmp_path / "small")
    folder = tmp_path / "out"
    folder.mkdir()
    assert EXPORTERS.get("csv")(dataset, folder, lambda: None) == []
    trials = pd.read_csv(folder / "trials.csv")
    assert list(trials["target"]) == ["near", "far"] == list(trials["distance"])
    for trial in dataset.trials:
        table = pd.read_csv(folder / "recordings" / f"{trial.recording}.csv")
        messages = list(dataset.observations(trial))
        np.testing.assert_allclose(table["t"], [message.t for message in messages], rtol=1e-8)
        np.testing.assert_allclose(
            table[[f"hand_right_{axis}" for axis in "xyz"]],
            [message.hands["right"].position for message in messages], rtol=1e-8,
        )  # fmt: skip
    explained = pd.read_csv(folder / "columns.csv")
    assert list(explained.columns) == ["column", "unit", "meaning"]
