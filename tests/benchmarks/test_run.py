"""The bars, from what was measured."""

from benchmarks import run


def report(update, embree, memory=None, idle=True):
    measured = {
        "machine": {"idle": idle},
        "peers": {
            "best": {"igrip, update": {"p50_ms": update, "p99_ms": 2 * update}},
            "ratios": {"update / embreex, rays alone": update / embree},
        },
        "growth": {"objects": [{"case": n, "p50_ms": update * n / 4} for n in (1, 4, 20, 100)]},
        "batch": {"times_real_time": 99.0},
    }
    return measured | ({} if memory is None else {"memory": {"growth_mb": memory}})


def test_bars_are_reached_or_not():
    rows = {row["quantity"]: row for row in run.bars(report(0.3, 0.1, memory=0.5))}
    assert rows["update / embreex, rays alone"]["measured"] == 0.3 / 0.1
    assert not rows["update / embreex, rays alone"]["reached"]
    assert not rows["100 objects / 4 objects"]["reached"]  # 25
    assert rows["update, p50 [ms], if idle"]["reached"]
    busy = {row["quantity"]: row for row in run.bars(report(0.3, 0.1, idle=False))}
    assert busy["update, p50 [ms], if idle"]["reached"] is None
    assert rows["growth of memory [MB]"]["reached"]
    assert not rows["replay, times real time"]["reached"]
    fast = {row["quantity"]: row for row in run.bars(report(0.2, 0.1))}
    assert fast["update / embreex, rays alone"]["reached"]
    assert "growth of memory [MB]" not in fast  # not measured
    assert "trimesh without embree, rays alone / update" not in fast
