"""``igrip export``: whole folders or none, and words that name what was left out."""

from typer.testing import CliRunner

from datasets import write_small_dataset
from igrip.cli.app import app

run = CliRunner().invoke


def test_it_says_what_was_written_and_left_out(tmp_path):
    dataset = write_small_dataset(tmp_path / "small")
    dataset.recording(dataset.trials[1]).unlink()
    done = run(app, ["export", str(dataset.path), "--out", str(tmp_path / "bids")])
    assert done.exit_code == 0, done.output
    assert "1 recordings in" in done.output
    assert "left out: reach1" in done.stderr
    assert (tmp_path / "bids" / "dataset_description.json").exists()
    assert not list(tmp_path.glob(".bids*"))


def test_a_failure_leaves_no_folder(tmp_path, monkeypatch):
    dataset = write_small_dataset(tmp_path / "small")

    def full(*arguments, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("igrip.io.exporters.motion_bids._write_run", full)
    done = run(app, ["export", str(dataset.path), "--out", str(tmp_path / "bids")])
    assert done.exit_code != 0
    assert [path.name for path in tmp_path.iterdir()] == ["small"]


def test_a_wrong_format_suggests_the_near_one(tmp_path):
    dataset = write_small_dataset(tmp_path / "small")
    options = ["--out", str(tmp_path / "x"), "--format", "motion_bid"]
    done = run(app, ["export", str(dataset.path), *options])
    assert done.exit_code != 0
    assert "motion_bids" in done.stderr
