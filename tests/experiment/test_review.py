"""Reviews: what is found, corrected, logged, and in the table that an evaluation reads."""

import json

import numpy as np
import pytest

from igrip.experiment.folder import StudyFolder
from igrip.experiment.journal import read_events
from igrip.experiment.review import Review
from igrip.experiment.session import Session
from igrip.experiment.simulated import SimulatedRecorder
from igrip.experiment.study import StudyError
from igrip.experiment.unattended import run_unattended
from igrip.io.datasets.dataset import Dataset
from igrip.io.datasets.trial import read_trials
from igrip.io.mcap.frame_recorder import FrameRecorder
from igrip.io.mcap.writer import McapWriter
from igrip.objects.catalog import load_objects
from live_fakes import Clock, frame
from small_study import small_study


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A study with all trials of one simulated participant; the first one was repeated."""
    folder = small_study(tmp_path_factory.mktemp("review") / "study")
    recorder = SimulatedRecorder(folder.study, load_objects(*folder.study.models), "P01")
    session = Session(folder, folder.enrol("P01", "2026-01-31"), recorder)
    session.start()
    session.stop()
    session.repeat()
    for _ in run_unattended(session):
        pass
    session.mark_wrong()  # the last one
    session.close()
    return folder.path


@pytest.fixture
def review(recorded, tmp_path):
    import shutil

    shutil.copytree(recorded, tmp_path / "study")
    found = Review(StudyFolder(tmp_path / "study"), "P01")
    found.read()
    yield found
    found.close()


def rows(review):
    return {one.trial.recording: review.summary(one.trial.recording) for one in review}


def table(review):
    path = review._folder.path / "trials.tsv"
    return {row.recording: row for row in read_trials(path, lenient=False)}


def test_every_recording_is_there_with_its_movement(review):
    found = rows(review)
    assert len(found) == len(review) == 18
    for row in found.values():
        assert row["bounds"] is not None
        assert not row["corrected"]
        assert row["valid"] or row["reason"]
    assert sum(row["repeated"] for row in found.values()) == 2
    assert [row["trial"] for row in found.values() if not row["performed"]] == [1, 1, 8, 8]


def test_a_correction_is_in_the_table_and_the_old_one_in_the_log(review):
    name = "P01_t003_left"
    before = review.summary(name)["bounds"]
    times = review[name].recorded.times
    first = (times[0] + 0.1, times[-1] - 0.1)
    review.correct(name, *first)
    review.correct(name, before[0] + 0.01, before[1])
    row = table(review)[name]
    assert (row.onset_s, row.end_s) == pytest.approx((before[0] + 0.01, before[1]), abs=1e-6)
    assert row.extra["reviewed"] == "yes"
    assert table(review)["P01_t003_right"].onset_s is None  # another camera, another clock
    events = read_events(review._folder.review("P01"))
    assert [event["event"] for event in events] == ["bounds_corrected"] * 2
    assert (events[0]["onset_s"], events[0]["end_s"]) == pytest.approx(first, abs=1e-6)
    assert events[0]["automatic"] == pytest.approx(before)
    review.withdraw(name)
    assert table(review)[name].onset_s is None
    assert review.summary(name)["bounds"] == before
    assert len(read_events(review._folder.review("P01"))) == 3  # nothing is overwritten


def test_a_judgement_holds_for_all_cameras_of_the_attempt(review):
    review.judge("P01_t002_left", False)
    review.judge("P01_t008_right", True)
    told = {name: row.performed for name, row in table(review).items()}
    assert {told["P01_t002_left"], told["P01_t002_right"]} == {"no"}
    assert {told["P01_t008_left"], told["P01_t008_right"]} == {"yes"}
    assert not review.summary("P01_t002_right")["valid"]
    assert review.summary("P01_t002_right")["reason"] == "was not performed"


def test_corrections_survive_the_next_session_and_a_new_review(review):
    review.correct("P01_t002_left", *(t + 0.05 for t in review.summary("P01_t002_left")["bounds"]))
    corrected = table(review)["P01_t002_left"].onset_s
    review.close()
    folder = review._folder
    recorder = SimulatedRecorder(folder.study, load_objects(*folder.study.models), "P01")
    Session(folder, folder.enrol("P01", None), recorder).close()
    assert table(review)["P01_t002_left"].onset_s == corrected
    again = Review(StudyFolder(folder.path), "P01")
    again.read()
    assert again.summary("P01_t002_left")["corrected"]
    again.close()


@pytest.mark.parametrize(
    "bounds", [(0.5, 0.5), (1.0, 0.5), (-1.0, 0.5), (0.5, 1e9), (np.nan, 1.0), (0.5, np.inf)]
)
def test_impossible_times_are_refused(review, bounds):
    with pytest.raises(StudyError, match="must lie within"):
        review.correct("P01_t001_left", *bounds)
    assert table(review)["P01_t001_left"].onset_s is None


def test_strangers_and_unknown_recordings_are_refused(review):
    with pytest.raises(StudyError, match=r"P09: has not taken part; there are: P01"):
        Review(review._folder, "P09")
    with pytest.raises(StudyError, match="is no recording of P01"):
        review.judge("../../etc/passwd", True)


def test_a_damaged_recording_is_listed_with_its_damage(review):
    dataset = Dataset.open(review._folder.path)
    path = dataset.recording(dataset.trials[4])
    path.write_bytes(path.read_bytes()[:2000])
    review.read()
    row = rows(review)[dataset.trials[4].recording]
    assert not row["valid"]
    assert row["reason"]


def test_pictures_are_those_of_the_recording(review, tmp_path):
    dataset = Dataset.open(review._folder.path)
    clock = Clock()
    with McapWriter(dataset.recording(dataset.trials[0])) as writer:
        frames = FrameRecorder(writer)
        for _ in range(3):
            frames.add(frame(clock()))
        frames.close()
    pictures = review.pictures(dataset.trials[0].recording)
    assert len(pictures) == 3
    assert all(data[:3] == b"\xff\xd8\xff" for _, data in pictures)


def test_a_review_of_nothing_says_so(tmp_path):
    folder = small_study(tmp_path / "study")
    with pytest.raises(StudyError, match="P01: has not taken part; there are: nobody"):
        Review(folder, "P01")
    folder.enrol("P01", "2026-01-31")
    with pytest.raises(StudyError, match="nothing was recorded yet"):
        Review(folder, "P01")


def test_the_log_is_json_lines(review):
    review.judge("P01_t002_left", False)
    lines = review._folder.review("P01").read_text().splitlines()
    assert json.loads(lines[-1])["performed"] is False
