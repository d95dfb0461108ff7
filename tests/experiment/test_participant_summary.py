"""The page on one participant: counts and medians are those of the recordings."""

import re
from statistics import median

import pytest

from browser import accessibility_problems, needs_chromium, open_page
from igrip.config import Config
from igrip.experiment.folder import StudyFolder
from igrip.experiment.participant_summary import write_summary
from igrip.experiment.review import Review
from igrip.experiment.session import Session
from igrip.experiment.simulated import SimulatedRecorder
from igrip.experiment.unattended import run_unattended
from igrip.objects.catalog import load_objects
from small_study import small_study


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = small_study(tmp_path_factory.mktemp("summary") / "study")
    catalog = load_objects(*folder.study.models)
    session = Session(
        folder, folder.enrol("P01", "2026-01-31"), SimulatedRecorder(folder.study, catalog, "P01")
    )
    session.start()
    session.stop()
    session.repeat()
    for _ in run_unattended(session):
        pass
    session.close()
    review = Review(StudyFolder(folder.path), "P01")
    review.read()
    counted = []
    path = write_summary(
        folder, review, catalog, Config(targets="nearest"), lambda: counted.append(None)
    )
    assert len(counted) == 16  # without the attempt that was repeated
    yield review, path
    review.close()


def cells(text, factor, level):
    heads = "".join(f'<th scope="row">{head}</th>' for head in (factor, level))
    row = re.search(rf"{heads}(.*?)</tr>", text)[1]
    return re.findall(r"<td>(.*?)</td>", row)


def test_numbers_are_those_of_the_recordings(written):
    review, path = written
    text = path.read_text()
    rows = [review.summary(one.trial.recording) for one in review]
    rows = [row for row in rows if not row["repeated"]]
    valid = [row for row in rows if row["valid"]]
    assert f"{len(valid)} of 16 recordings are valid" in text
    assert "8 of 8 trials are done (8 recorded, 1 repeated)" in text
    for camera in ("left", "right"):
        own = [row for row in valid if row["camera"] == camera]
        found = cells(text, "camera", camera)
        assert found[:2] == ["8", str(len(own))]
        times = [row["bounds"][1] - row["bounds"][0] for row in own]
        assert found[2] == (f"{median(times):.2f}" if times else "–")
    assert text.count("<polyline") == len(valid)


@needs_chromium
def test_axe_finds_nothing_and_it_prints_on_one_page(written, tmp_path):
    with open_page(written[1].as_uri(), 820, 1180) as page:
        assert accessibility_problems(page) == []
        pdf = page.pdf(prefer_css_page_size=True)
    assert len(re.findall(rb"/Type\s*/Page\b", pdf)) == 1
