"""Moments of the demo, as the viewer gets them."""

from __future__ import annotations

from collections.abc import Callable
from itertools import islice

from igrip import Estimator
from igrip.lab.simulation.demo import DemoPerson
from igrip.objects.catalog import Catalog
from igrip.viewer.snapshot import Snapshot, rays_of, take_snapshot


def demo_moments(
    catalog: Catalog, each: Callable[[Snapshot], None] = lambda moment: None
) -> list[Snapshot]:
    """Run the demo until a hand reaches with rays that meet its target."""
    estimator, moments = Estimator(catalog), []
    for frame in islice(DemoPerson(catalog, 0), 200):
        estimator.update(frame.observation)
        moment = take_snapshot(estimator)
        moments.append(moment)
        each(moment)
        for hand in moment.hands:
            if hand.intention.status == "reaching" and len(rays_of(moment.scene, hand)[0]) > 20:
                return moments
    raise AssertionError("no such moment")
