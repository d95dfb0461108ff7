"""Ten minutes of demo with the page open: neither the server nor the page grows."""

from __future__ import annotations

import os
import time

import pytest

from browser import needs_chromium, open_page
from igrip import Estimator
from igrip.lab.simulation.demo import DemoPerson
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import take_snapshot

MINUTES = 10
SERVER_MB, PAGE_MB = 10.0, 10.0  # allowed between the third minute and the last


def resident_mb():
    """Return the resident size of this process [MB]."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def heap_mb(page):
    """Return what the page's scripts hold after a collection [MB]."""
    session = page.context.new_cdp_session(page)
    session.send("HeapProfiler.collectGarbage")
    metrics = session.send("Performance.enable") or session.send("Performance.getMetrics")
    session.detach()
    return {m["name"]: m["value"] for m in metrics["metrics"]}["JSHeapUsedSize"] / 1e6


@pytest.mark.slow
@pytest.mark.browser
@pytest.mark.timeout(60 * MINUTES + 300)
@needs_chromium
def test_memory_with_the_page_open(ycb):
    estimator, viewer = Estimator(ycb), Viewer(port=0, targets="repaired")
    sizes, frames, late = [], 0, 0
    try:
        with open_page(viewer.url) as page:
            begin, minute = time.monotonic(), 0
            for moment in DemoPerson(ycb, 0):
                wait = begin + moment.observation.t - time.monotonic()
                late += wait < -0.1
                time.sleep(max(0.0, wait))
                estimator.update(moment.observation)
                viewer.show(take_snapshot(estimator))
                frames += 1
                if moment.observation.t >= 60.0 * (minute + 1):
                    minute += 1
                    page.wait_for_timeout(1)  # let Playwright answer its messages
                    sizes.append((resident_mb(), heap_mb(page)))
                    print(
                        f"minute {minute}: server {sizes[-1][0]:.1f} MB, "
                        f"page {sizes[-1][1]:.1f} MB, drawn {viewer.drawn}, "
                        f"dropped {viewer.dropped}, late {late} of {frames}",
                        flush=True,
                    )
                    begin += max(0.0, time.monotonic() - begin - moment.observation.t)
                if minute == MINUTES:
                    break
    finally:
        viewer.close()
    server, heap = zip(*sizes, strict=True)
    assert server[-1] - server[2] < SERVER_MB, sizes
    assert heap[-1] - heap[2] < PAGE_MB, sizes
