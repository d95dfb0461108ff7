"""What the benchmark makes of its times."""

import pytest

from igrip.benchmark import run


def report(update, embree, memory=None, idle=True):
    told = {
        "machine": {"idle": idle},
        "peers": {
            "best": {"igrip, update": {"p50_ms": update, "p99_ms": 2 * update}},
            "ratios": {"update / embreex, rays alone": update / embree},
        },
        "growth": {"objects": [{"case": n, "p50_ms": update * n / 4} for n in (1, 4, 20, 100)]},
        "batch": {"times_real_time": 99.0},
    }
    return told | ({} if memory is None else {"memory": {"growth_mb": memory}})


def test_bars_are_reached_or_not():
    rows = {row["what"]: row for row in run.bars(report(0.3, 0.1, memory=0.5))}
    assert rows["update / embreex, rays alone"]["measured"] == 0.3 / 0.1
    assert not rows["update / embreex, rays alone"]["reached"]
    assert not rows["100 objects / 4 objects"]["reached"]  # 25
    assert rows["update, p50 [ms], if idle"]["reached"]
    busy = {row["what"]: row for row in run.bars(report(0.3, 0.1, idle=False))}
    assert busy["update, p50 [ms], if idle"]["reached"] is None
    assert rows["growth of memory [MB]"]["reached"]
    assert not rows["replay, times real time on a core"]["reached"]
    fast = {row["what"]: row for row in run.bars(report(0.2, 0.1))}
    assert fast["update / embreex, rays alone"]["reached"]
    assert "growth of memory [MB]" not in fast  # not measured
    assert "trimesh without embree, rays alone / update" not in fast


def test_ratios_are_of_medians_run_by_run():
    runs = [
        {run.OWN: {"p50_ms": own}, "peer": {"p50_ms": peer}, run.WITH_BAYES: {"p50_ms": bayes}}
        for own, peer, bayes in ((0.4, 0.2, 0.5), (0.3, 0.1, 0.6))
    ]
    assert run._ratios_of_runs(runs) == {
        "update / peer": [2.0, pytest.approx(3.0)], run.DEARER: [1.25, 2.0]
    }  # fmt: skip
    ratios = run._ratios(runs, {"p50_ms": 30.0})
    assert ratios["update / peer"] == 2.0  # the best
    assert ratios["trimesh without embree, rays alone / update"] == 30.0 / 0.35
