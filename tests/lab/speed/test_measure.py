"""Ratios of medians, and contestants that are not installed."""

import pytest

from igrip.lab.speed import measure, peers
from igrip.lab.speed.measure import BAYES_RATIO, OWN, WITH_BAYES
from igrip.lab.speed.peers import EMBREE, Recorded


def test_ratios_are_of_medians_run_by_run():
    runs = [
        {OWN: {"p50_ms": own}, "peer": {"p50_ms": peer}, WITH_BAYES: {"p50_ms": bayes}}
        for own, peer, bayes in ((0.4, 0.2, 0.5), (0.3, 0.1, 0.6))
    ]
    of_runs = measure.ratios_of_runs(runs, ["peer"])
    assert of_runs == {"update / peer": [2.0, pytest.approx(3.0)], BAYES_RATIO: [1.25, 2.0]}
    ratios = measure.best_ratios(of_runs, runs, {"p50_ms": 30.0})
    assert ratios["update / peer"] == 2.0
    assert ratios["trimesh without embree, rays alone / update"] == 30.0 / 0.35
    assert set(measure.best_ratios(of_runs, runs, None)) == {"update / peer", BAYES_RATIO}


def test_engines_that_are_not_installed_are_left_out_and_named(ycb, monkeypatch):
    def absent(objects):
        raise ImportError("No module named 'engine'")

    monkeypatch.setattr(peers, "Embree", absent)
    monkeypatch.setattr(peers, "PlainTrimesh", absent)
    scene = Recorded.run(ycb, 20)
    report = measure.compare(ycb, scene, scene.embree(), runs=2, plain_frames=1)
    assert report["missing"] == ["No module named 'engine'"] * 2
    assert report["plain_trimesh"] is None
    assert set(report["best"]) == {OWN, WITH_BAYES}
    assert set(report["ratios"]) == {BAYES_RATIO}
    assert len(report["runs"]) == 2


def test_the_rays_of_a_frame_are_cast_by_every_engine(ycb):
    pytest.importorskip("embreex", reason="no wheel for this machine")
    scene = Recorded.run(ycb, 20)
    assert len(scene.rays) == peers.WARM_UP + 20
    assert scene.rays[0] is None  # no hand moves yet
    contestants = scene.embree()
    assert set(contestants) == {EMBREE}
    frame = 25  # the hands are on their way to the objects
    hits = contestants[EMBREE](frame)
    assert contestants[EMBREE](0) is None
    plain = peers.PlainTrimesh(scene.objects).cast(scene.rays[frame])
    assert max(abs(a - b) for a, b in zip(hits, plain, strict=True)) <= 2  # single precision
    assert sum(plain) > 0


def test_memory_of_a_run(ycb):
    assert measure.memory(ycb, 400)["frames"] == 400  # longer than a lap: time goes on
