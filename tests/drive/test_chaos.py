"""Nothing goes on without a lease, whatever goes wrong: judged at the device, in virtual time."""

from __future__ import annotations

import itertools

import pytest

from drive.chaos import World, check
from igrip.drive import supervisor


def starts(world):
    outputs = world.twin.outputs
    return sum(b.active and not a.active for a, b in itertools.pairwise(outputs))


def test_two_thousand_faults(ycb):
    world = World(ycb, seed=1)
    world.run(faults=2000, rate=0.3)
    assert check(world) == []
    assert starts(world) > 20  # it was not simply silent
    assert len(world.counts) >= 16  # every kind happened


@pytest.mark.parametrize("blind", ["margin", "end", "twice"])
def test_the_observer_sees_what_the_supervisor_is_for(ycb, monkeypatch, blind):
    """Without one of its rules something goes wrong, and the observer says so."""
    if blind == "margin":
        defaults = supervisor.Supervisor.__init__.__defaults__
        assert defaults[2] == supervisor.MARGIN
        monkeypatch.setattr(
            supervisor.Supervisor.__init__, "__defaults__", (*defaults[:2], -0.1, *defaults[3:])
        )
    elif blind == "end":
        monkeypatch.setattr(supervisor.Supervisor, "stop", lambda self: None)
        monkeypatch.setattr("drive.chaos.LINE_DELAY", 0.5)
    else:
        monkeypatch.setattr("igrip.devices.twins.serial.is_newer", lambda sequence, than: True)
        monkeypatch.setattr("drive.chaos.LINE_DELAY", 0.5)
    world = World(ycb, seed=2)
    world.run(faults=700, rate=0.1)
    assert check(world)


@pytest.mark.slow
@pytest.mark.timeout(7200)
def test_a_hundred_thousand_faults(ycb):
    """In pieces, each with another person and other sensor faults."""
    total = begun = 0
    for seed in range(25):
        world = World(ycb, seed=100 + seed)
        world.run(faults=4000, rate=(0.1, 0.3, 1.0)[seed % 3])
        assert check(world) == []
        total += world.faults
        begun += starts(world)
    print(f"{total} faults, {begun} actions, no violation")
    assert total >= 100_000
    assert begun > 500
