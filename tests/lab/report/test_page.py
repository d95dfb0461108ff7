"""The report: one page with everything in it, and the files beside it."""

import html
import json
import math
import re

import pandas as pd
import pytest

from browser import needs_chromium, open_page
from igrip import Config, load_objects
from igrip.io.datasets.dataset import Dataset
from igrip.lab.evaluation.evaluation import Evaluation
from igrip.lab.evaluation.summary import frame_of, summarise
from igrip.lab.parallel import Workers
from igrip.lab.report import page
from igrip.lab.report.claims import deviations, findings
from igrip.lab.report.page import clean, error, percent, typical, write_report
from igrip.lab.simulation.cohort import simulate_cohort
from igrip.lab.simulation.parameters import cohort_parameters
from igrip.version import __version__

TARGETS = ("paper", "impacts", "distance_derivative", "distance", "future_distance")


CONFIGS = [Config(targets=name) for name in TARGETS]


@pytest.fixture(scope="module")
def evaluated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    catalog = load_objects("ycb")
    list(
        simulate_cohort(
            folder / "cohort", catalog, cohort_parameters(), 2, 0, trials=3, no_reach_minutes=1
        )
    )
    dataset = Dataset.open(folder / "cohort")
    evaluation = Evaluation(dataset, CONFIGS, folder / "out")
    list(evaluation.run(dataset.trials, Workers()))
    return dataset, catalog, frame_of(evaluation.rows)


@pytest.fixture(scope="module")
def report(evaluated, tmp_path_factory):
    dataset, catalog, frame = evaluated
    out = tmp_path_factory.mktemp("report") / "out"
    summary = summarise(frame, "<b>bold & \u00fcber</b>", TARGETS)
    summary["without_trials"] = ["p99"]
    summary["excluded"] = [
        {"recording": "<script>alert(1)</script>", "participant": None, "problem": "gone"}
    ]
    write_report(out, dataset, catalog, CONFIGS, frame, summary, command="igrip evaluate 'a & b'")
    return out, summary, frame


def test_files(report):
    out, summary, frame = report
    told = json.loads((out / "summary.json").read_text())
    assert told["targets"]["paper"]["all"] == clean(summary["targets"]["paper"]["all"])
    assert told["schema"] == "igrip-summary/1"
    table = pd.read_parquet(out / "trials.parquet")
    assert len(table) == len(frame) == 5 * 13
    for name in ("participants", "accuracy", "courses"):
        assert (out / "figures" / f"{name}.png").stat().st_size > 20_000
        assert (out / "figures" / f"{name}.svg").read_text().startswith("<?xml")


def test_the_page_is_whole_and_says_what_was_found(report):
    out, summary, _ = report
    page = (out / "report.html").read_text()
    assert not re.search(r"(src|href)=\"(?!data:|#)", page)  # nothing is fetched
    assert page.count("data:image/svg+xml;base64,") == 4
    for name in TARGETS:
        assert f'<th scope="row"><code>{name}</code></th>' in page
    assert percent(summary["targets"]["paper"]["valid"]["success"]) in page
    assert "89.9 %" in page  # as published, beside ours
    times = summary["targets"]["paper"]["times"]["all"]["end"]["60%"]
    assert f"<td>{error(times)}</td>" in page
    first = summary["targets"]["paper"]["first_commitments"]["all"]
    assert f"<td>all</td><td>{percent(first['committed'])}</td>" in page
    assert "What the publication claims" in page
    assert "p99" in page


def test_names_from_outside_are_escaped(report):
    page = (report[0] / "report.html").read_text()
    assert "<script>" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert "&lt;b&gt;bold &amp; \u00fcber&lt;/b&gt;" in page


def test_it_says_by_what_it_was_made(report):
    """Version, command, dataset, estimators and every number of the configuration."""
    text = html.unescape((report[0] / "report.html").read_text())
    assert f"igrip {__version__} with <code>igrip evaluate 'a & b'</code>" in text
    told = json.loads(re.search(r"<pre>(.*?)</pre>", text, re.DOTALL)[1])
    assert Config(**told) == Config()


def test_method_and_publication_never_share_a_name(report):
    """`paper` is an estimator; the publication's numbers are called published."""
    text = re.sub(r"<code>.*?</code>", "ESTIMATOR", (report[0] / "report.html").read_text())
    words = re.sub(r"<(style|pre).*?</\1>|<[^>]*>", " ", text, flags=re.DOTALL)
    assert "published" in words
    assert not re.search(r"\bpaper\b", words)


def test_every_place_of_the_contents_is_there_and_every_section_is_in_them(report):
    page = (report[0] / "report.html").read_text()
    contents = re.search(r"<nav.*?</nav>", page, re.DOTALL)[0]
    assert re.findall(r'href="#([^"]+)"', contents) == re.findall(r'<h2 id="([^"]+)"', page)


def test_every_row_of_a_table_is_as_wide_as_its_head(report):
    page = (report[0] / "report.html").read_text()
    tables = re.findall(r"<table.*?</table>", page, re.DOTALL)
    assert len(tables) > 8
    for table in tables:
        widths = set()
        for row in re.findall(r"<tr.*?</tr>", table, re.DOTALL):
            cells = re.findall(r"<t[hd]([^>]*)>(.*?)</t[hd]>", row, re.DOTALL)
            widths.add(sum(int((re.search(r'colspan="(\d+)"', a) or [0, 1])[1]) for a, _ in cells))
            assert all(text.strip() for attributes, text in cells[2:]), row  # no empty cell
        assert len(widths) == 1, table[:300]


@pytest.mark.browser
@needs_chromium
def test_it_fits_a_phone_and_axe_finds_nothing_and_it_prints_on_one_page(report):
    from axe_playwright_python.sync_playwright import Axe

    with open_page((report[0] / "report.html").as_uri(), 390, 844) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        found = Axe().run(page).response["violations"]
        assert [(rule["id"], [n["html"][:200] for n in rule["nodes"]]) for rule in found] == []
        paper = page.pdf(prefer_css_page_size=True)
    assert len(re.findall(rb"/Type\s*/Page\b", paper)) == 1


@pytest.mark.parametrize("grips", ["contact", "cylinder"])
def test_the_time_courses_are_of_the_same_configuration(evaluated, tmp_path, monkeypatch, grips):
    dataset, catalog, frame = evaluated
    configs = [Config(targets=name, grips=grips) for name in ("distance", "paper")]
    runs = []
    run_trial = page.run_trial
    monkeypatch.setattr(page, "run_trial", lambda *args: runs.append(args) or run_trial(*args))
    summary = summarise(frame, "x", ["distance", "paper"])
    chosen = dataset.trials[1]
    write_report(tmp_path, dataset, catalog, configs, frame, summary, chosen.recording)
    assert runs == [(dataset, chosen, catalog, [configs[1]])]


@pytest.mark.parametrize("kept", ["nothing", "one", "none"])
def test_reports_of_small_and_empty_datasets(evaluated, tmp_path, kept):
    dataset, catalog, frame = evaluated
    first = frame["recording"] == typical(frame[frame["targets"] == "paper"])
    part = {"nothing": frame[:0], "one": frame[first], "none": frame[frame["target"] == "none"]}
    summary = summarise(part[kept], "x", TARGETS)
    write_report(tmp_path, dataset, catalog, CONFIGS, part[kept], summary)
    assert "<h2 id" in (tmp_path / "report.html").read_text()
    assert summary["recordings"] == {"none": 1, "nothing": 0, "one": 1}[kept]
    assert (tmp_path / "figures" / "courses.png").exists() == (kept == "one")


def test_a_typical_trial_is_a_successful_one_near_the_medians():
    rows = pd.DataFrame(
        {
            "recording": list("abcd"), "target": "cup", "problem": None,
            "valid": [True, True, True, False], "success": [True, True, False, True],
            "delay_s": [0.1, 0.5, None, 0.3], "margin_s": [0.5, 0.5, None, 0.5],
        }
    )  # fmt: skip
    assert typical(rows) in ("a", "b")
    assert typical(rows[rows["recording"] == "c"]) is None


def scored(success, delay, clipped=None, grip=None):
    clipped = delay if clipped is None else clipped
    told = {"success": success, "delay_s": delay, "delay_clipped_s": clipped, "frames": success}
    return {"valid": told if grip is None else told | {"grip_success": grip}}


def test_claims_hold_or_do_not():
    summary = {"targets": {
        "paper": scored(0.90, 0.5, grip=0.95), "impacts": scored(0.3, 0.9),
        "distance_derivative": scored(0.7, 0.4), "distance": scored(0.88, -0.1, 0.6),
        "future_distance": scored(0.91, 0.5),
    }}  # fmt: skip
    told = {f.claim: f.holds for f in findings(summary)}
    assert told == {
        "the global score beats every single metric": False,
        "the distance derivative is the earliest": False,
        "impacts are the latest": True,
        "the distance derivative is the earliest, runs before the onset counted as 0": True,
        "impacts are the latest, runs before the onset counted as 0": True,
        "impacts are the worst": True,
        "the grip is found more often": True,
    }
    assert findings({"targets": {}}) == []
    assert any(line.startswith("`paper`, frames: 90.0%") for line in deviations(summary))
    assert not any(line.startswith("`paper`, success") for line in deviations(summary))


def test_what_is_not_finite_is_null():
    told = clean({"a": [1.0, math.nan, {"b": math.inf}], "c": "nan"})
    assert told == {"a": [1.0, None, {"b": None}], "c": "nan"}


def test_errors_in_milliseconds():
    assert error({"median_s": 0.0444, "p90_s": 0.1}) == "44 / 100"
    assert error({"asked": 3, "given": 0.0}) == "\u2013"
