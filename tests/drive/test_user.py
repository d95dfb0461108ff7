"""The user's say: what a text names, and what a signal means."""

from __future__ import annotations

import math
import os
import time
import tty

import numpy as np
import pytest

from igrip.drive.user import RmsMeter, parse_signal
from igrip.errors import IgripError
from runtime_fakes import stays_open, until


def test_a_key_is_a_letter():
    assert parse_signal("key:x") == "x"


@pytest.mark.parametrize("text", ["x", "key:", "key:xy", "emg:a>1", "emg:a/0>x", "marker:a", ""])
def test_what_names_nothing_is_refused(text):
    with pytest.raises(IgripError, match="expected key"):
        parse_signal(text)


def test_a_button_on_a_serial_line():
    pytest.importorskip("serial")
    main, side = os.openpty()
    tty.setraw(side)
    pressed = []
    signal = parse_signal(f"serial:{os.ttyname(side)}")
    signal.start(lambda: pressed.append(time.monotonic()), lambda text: None)
    os.write(main, b"x")
    until(lambda: pressed)
    assert len(pressed) == 1
    signal.close()
    os.close(main)
    os.close(side)


def test_a_lost_button_counts_as_pressed():
    pytest.importorskip("serial")
    main, side = os.openpty()
    tty.setraw(side)
    pressed, warned = [], []
    signal = parse_signal(f"serial:{os.ttyname(side)}")
    signal.start(lambda: pressed.append(1), warned.append)
    os.close(side)
    os.close(main)
    until(lambda: pressed and warned)
    assert pressed == [1]
    assert all(isinstance(text, str) and text for text in warned)
    signal.close()


def test_a_marker_and_an_emg_on_lsl():
    pylsl = pytest.importorskip("pylsl")
    name = f"igrip-test-{os.getpid()}"
    text, emg = (
        stays_open(pylsl.StreamOutlet(pylsl.StreamInfo(*info)))
        for info in (
            (f"{name}-m", "Markers", 1, 0, "string", f"{name}-m"),
            (f"{name}-e", "EMG", 2, 200, "float32", f"{name}-e"),
        )
    )
    said = []
    signals = [parse_signal(f"marker:{name}-m=stop now"), parse_signal(f"emg:{name}-e/1>0.5")]
    for signal, what in zip(signals, ("marker", "emg"), strict=True):
        signal.start(lambda what=what: said.append(what), said.append)
    until(lambda: text.have_consumers() and emg.have_consumers())
    text.push_sample(["go on"])
    time.sleep(0.2)
    assert said == []  # another marker, and a muscle at rest

    def both():
        text.push_sample(["stop now"])
        emg.push_chunk([[0.0, 2.0 * (-1) ** k] for k in range(20)])
        time.sleep(0.05)
        return {"marker", "emg"} <= set(said)

    until(both)
    for signal in signals:
        signal.close()


def test_the_meter_is_the_root_mean_square_of_a_tenth_of_a_second():
    rng = np.random.default_rng(1)
    rate, threshold = 1000.0, 1.0
    loud = (np.arange(4000) // 1000) % 2 == 1
    values = rng.normal(size=4000) * np.where(loud, 2.0, 0.3)
    meter, found = RmsMeter(threshold), []
    for k, value in enumerate(values):
        if meter.add(float(value), k / rate):
            found.append(k)
    squares = np.concatenate([[0.0], np.cumsum(values**2)])
    k = np.arange(4000)
    first = np.maximum(k - 100, 0)
    rms = np.sqrt((squares[k + 1] - squares[first]) / (k + 1 - first))
    crossings = np.flatnonzero((rms[1:] > threshold) & (rms[:-1] <= threshold)) + 1
    assert found == [crossings[crossings > 900][0], crossings[crossings > 2900][0]]
    assert meter.add(math.nan, 9.0) is False
