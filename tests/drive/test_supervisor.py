"""The supervisor on a virtual clock, judged by what the twin at the end of the line does."""

from __future__ import annotations

import pytest

from drive.lines import NOTHING, Rig
from igrip.devices.base.device import DeviceError
from runtime_fakes import Clock


@pytest.fixture
def rig():
    return Rig(Clock(10.0))


def test_it_acts_on_a_lease_and_stops_before_its_end(rig):
    rig.say()
    assert rig.twin.active
    begin = rig.clock.t
    rig.wait(0.3)
    assert not rig.twin.active
    assert rig.twin.outputs[-1].t - begin <= 0.12


def test_renewal_keeps_it_acting_and_one_message_without_a_lease_ends_it(rig):
    for _ in range(30):
        rig.say()
        rig.wait(0.032)
        assert rig.twin.active
    rig.say(**NOTHING)
    assert not rig.twin.active


def test_no_decision_is_acted_on_twice(rig):
    message = rig.message()
    for _ in range(20):
        decision = rig.receiver.read(message)
        if decision is not None:
            rig.supervisor.receive(decision)
        rig.wait(0.02)
    assert len(rig.twin.accepted) == 1
    assert rig.receiver.counts["repeated"] == 19


def test_it_closes_near_the_contact_and_when_the_hand_holds(rig):
    rig.say(time_to_contact=1.0)
    rig.wait(0.032)
    assert "phase 0" in rig.twin.outputs[-1].text
    rig.say(time_to_contact=0.2)
    rig.wait(0.032)
    assert "phase 1" in rig.twin.outputs[-1].text
    rig.say(time_to_contact=0.6)  # a later prediction does not open it again
    rig.wait(0.032)
    assert "phase 1" in rig.twin.outputs[-1].text


def test_a_veto_ends_the_lease_for_good(rig):
    rig.say()
    rig.supervisor.veto()
    assert not rig.twin.active
    assert rig.said == ["veto"]
    for _ in range(60):  # the estimator has not heard of it
        rig.say()
        rig.wait(0.032)
        assert not rig.twin.active
    rig.say(**NOTHING)
    rig.say(commitment={"target": "cup", "grip": "palmar", "since": 5.0})
    assert rig.twin.active


def test_a_stop_lasts_until_it_is_taken_back(rig):
    rig.say()
    rig.supervisor.stop()
    for k in range(60):
        rig.say(commitment={"target": "cup", "grip": "palmar", "since": float(k)})
        rig.wait(0.032)
        assert not rig.twin.active
    rig.supervisor.resume()
    rig.say(commitment={"target": "cup", "grip": "palmar", "since": 99.0})
    assert rig.twin.active


def test_a_fault_of_the_device_stops_it_until_it_is_resumed(rig):
    rig.say()
    rig.twin.fault = True
    rig.wait(0.15)
    assert rig.supervisor.fault is not None
    rig.twin.fault = False
    rig.wait(0.15)
    rig.say()
    assert not rig.twin.active
    rig.supervisor.resume()
    rig.say()
    assert rig.twin.active


def test_a_stop_that_cannot_be_sent_is_sent_again_and_again(rig):
    rig.say()
    rig.line.broken = True
    rig.wait(0.3)
    assert not rig.twin.active  # it stopped by itself
    assert rig.supervisor.fault is not None
    stops = rig.supervisor.counts["stops"]
    rig.wait(0.3)
    assert rig.supervisor.counts["stops"] > stops
    rig.line.broken = False
    rig.wait(0.1)
    stops = rig.supervisor.counts["stops"]
    rig.wait(0.3)
    assert rig.supervisor.counts["stops"] == stops


def test_whatever_a_library_raises_ends_in_a_stop(rig, monkeypatch):
    monkeypatch.setattr(rig.device, "allow", lambda permit: 1 / 0)
    rig.say()
    assert "division" in rig.supervisor.fault
    assert rig.supervisor.acting is None


def test_a_grip_without_a_pattern_is_refused(rig):
    rig.say(commitment={"target": "cup", "grip": "lateral", "since": 1.0})
    assert not rig.twin.active
    assert rig.supervisor.counts["refused"] == 1


def test_what_is_held_is_kept_in_silence_and_let_go_when_the_hand_goes():
    rig = Rig(Clock(10.0), when_silent="keep")
    kept = []
    stop = rig.device.stop
    rig.device.stop = lambda cause="end": (kept.append(cause), stop(cause))
    for _ in range(30):
        rig.say(status="holding")
        rig.wait(0.032)
    assert rig.supervisor.state.condition == "holding"
    rig.say(status="lost", **NOTHING)
    assert kept[-1] == "silence"
    rig.wait(0.032)
    rig.say(status="reaching", **NOTHING)
    assert kept[-1] == "end"


def test_the_estimator_hears_that_the_device_has_opened(rig):
    for _ in range(30):
        rig.say(status="holding")
        rig.wait(0.032)
    rig.say(status="reaching", **NOTHING)
    rig.wait(0.15)
    assert rig.said == ["opened"]


def test_a_thousand_messages_a_second_are_thinned_out(rig):
    for _ in range(500):
        rig.say()
        rig.wait(0.001, step=0.001)
    assert 40 <= len(rig.twin.accepted) <= 51


def test_closing_stops_it(rig):
    rig.say()
    rig.supervisor.close()
    assert not rig.twin.active
    with pytest.raises(DeviceError):
        rig.device.keep_alive()
