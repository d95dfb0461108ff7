"""What a certificate says: the latencies of a run, and the times to stop after faults."""

from __future__ import annotations

import bisect
import os
import platform
import resource
import signal
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from igrip.errors import IgripError
from igrip.lab.certificate.chain import Chain
from igrip.objects.catalog import Catalog
from igrip.version import __version__

ACTION_TIMEOUT = 60.0  # s until the simulated person reaches
STOP_TIMEOUT = 10.0  # s
PACKAGES = ("numpy", "numba", "scipy", "websockets", "pyserial")
SCHEMA = "igrip-certificate/1"

FAULTS = {
    "lost hand": "the hand is not seen any more",
    "lost camera": "no observation comes any more",
    "killed estimator": "igrip stream is killed (SIGKILL)",
    "killed driver": "igrip drive is killed (SIGKILL)",
    "hung estimator": "igrip stream is stopped (SIGSTOP)",
    "full disk": "igrip stream cannot write to any file; then no observation comes any more",
    "pulled port": "nothing reaches the device any more",
}


@dataclass(frozen=True)
class Limits:
    """What the user accepts.

    Attributes
    ----------
    latency : float
        From an observation to its intention, 99 % [ms].
    stop : float
        From the last good observation to the stop at the device, each time [ms].
    missed : float
        Share of observations without an intention by the limit.
    """

    latency: float = 100.0
    stop: float = 200.0
    missed: float = 0.01


@dataclass
class Stop:
    """Times from the last good observation to the stop at the device, after one fault [ms]."""

    fault: str
    meaning: str
    times: list[float] = field(default_factory=list)
    never: int = 0  # how often it had not stopped after 10 s


def latencies(
    sent: Sequence[tuple[float, bool]], received: Sequence[tuple[float, dict[str, Any]]],
    deadline: float,
) -> dict[str, Any]:  # fmt: skip
    """Return what a run says of latency.

    An intention follows from the newest observation that had left when the service received one:
    ``sent - age``, on the clock that all processes of a machine share.

    Parameters
    ----------
    sent : sequence of (float, bool)
        When each observation left [s].
    received : sequence of (float, dict)
        When each intention came [s], and the message.
    deadline : float
        Until when an intention must have come [ms].

    Returns
    -------
    dict
        ``count``, ``p50``, ``p99``, ``max``, ``jitter`` (standard deviation) [ms], ``missed``.
    """
    left = [t for t, _ in sent]
    first: dict[int, float] = {}
    for came, message in received:
        arrived = message["sent"] - message["age"]
        cause = bisect.bisect_right(left, arrived) - 1
        if cause >= 0 and came >= left[cause]:
            first.setdefault(cause, (came - left[cause]) * 1000.0)
    times = sorted(first.values())
    if len(times) < 2:
        raise IgripError("too few intentions came to measure a latency")
    in_time = sum(time <= deadline for time in times)
    return {
        "count": len(left), "answered": len(times), "p50": statistics.median(times),
        "p99": times[min(len(times) - 1, int(0.99 * len(times)))], "max": times[-1],
        "jitter": statistics.pstdev(times), "missed": 1.0 - in_time / len(left),
    }  # fmt: skip


def measure(
    device: str, config: Path, catalog: Catalog, folder: Path, limits: Limits, seconds: float,
    repeats: int, progress: Callable[[str], None] = lambda text: None,
) -> dict[str, Any]:  # fmt: skip
    """Run the chain, let faults befall it, and return the certificate as plain data."""
    before = os.getloadavg()
    progress(f"latency, {seconds:g} s")
    chain = Chain(device, config, catalog, folder)
    try:
        chain.start()
        time.sleep(seconds)
        time.sleep(0.5)
        found = latencies(chain.sent[:-15], list(chain.received), limits.latency)
    finally:
        chain.close()
    stops = []
    for name, meaning in FAULTS.items():
        stop = Stop(name, meaning)
        for k in range(repeats):
            progress(f"{name}, {k + 1} of {repeats}")
            taken = _stop_after(name, device, config, catalog, folder)
            if taken is None:
                stop.never += 1
            else:
                stop.times.append(taken)
        stops.append(stop)
    return {
        "schema": SCHEMA, "device": device, "hardware": "none: the device is a virtual twin",
        "when": datetime.now(UTC).isoformat(timespec="seconds"), "machine": _machine(),
        "load": {"before": before, "after": os.getloadavg()}, "limits": asdict(limits),
        "latency": found, "stops": [asdict(stop) for stop in stops],
        "verdict": verdict(found, stops, limits),
    }  # fmt: skip


def verdict(found: dict[str, Any], stops: Sequence[Stop], limits: Limits) -> list[str]:
    """Return what is beyond the limits, a sentence each; empty: all is within them."""
    beyond = []
    if found["p99"] > limits.latency:
        beyond.append(f"latency: 99 % within {found['p99']:.0f} ms, more than {limits.latency:g}")
    if found["missed"] > limits.missed:
        beyond.append(f"missed deadlines: {found['missed']:.1%}, more than {limits.missed:.1%}")
    for stop in stops:
        if stop.never:
            beyond.append(f"{stop.fault}: the device had not stopped after {STOP_TIMEOUT:g} s")
        elif max(stop.times) > limits.stop:
            beyond.append(
                f"{stop.fault}: stopped after {max(stop.times):.0f} ms, more than {limits.stop:g}"
            )
    return beyond


def _stop_after(
    fault: str, device: str, config: Path, catalog: Catalog, folder: Path
) -> float | None:
    """Return how long the device acted after the last good observation [ms]; None: it goes on."""
    person = folder / "person.json"
    person.unlink(missing_ok=True)
    options = ("--person", str(person)) if fault == "full disk" else ()
    chain = Chain(device, config, catalog, folder, options)
    try:
        chain.start()
        if not chain.wait_for_action(ACTION_TIMEOUT):
            raise IgripError(f"{device}: the device did not act within {ACTION_TIMEOUT:g} s")
        _befall(fault, chain)
        if not chain.wait_for_stop(STOP_TIMEOUT):
            return None
        stopped = chain.server.twin.outputs[-1].t
        cause = chain.last_good()
        if fault in ("killed estimator", "hung estimator", "pulled port", "killed driver"):
            cause = chain.befallen
        return max(0.0, stopped - cause) * 1000.0
    finally:
        for process in (chain.stream, chain.drive):
            if process is not None and process.poll() is None:
                process.send_signal(signal.SIGCONT)
        chain.close()


def _befall(fault: str, chain: Chain) -> None:
    assert chain.stream is not None
    assert chain.drive is not None
    chain.befallen = time.monotonic()
    if fault == "lost hand":
        chain.mode = "no hand"
    elif fault == "lost camera":
        chain.mode = "silent"
    elif fault == "killed estimator":
        chain.stream.kill()
    elif fault == "killed driver":
        chain.drive.kill()
    elif fault == "hung estimator":
        chain.stream.send_signal(signal.SIGSTOP)
    elif fault == "full disk":
        resource.prlimit(chain.stream.pid, resource.RLIMIT_FSIZE, (0, 0))
        chain.mode = "silent"
    elif fault == "pulled port":
        chain.server.pulled = True
    else:
        raise ValueError(fault)


def _machine() -> dict[str, Any]:
    versions = {"igrip": __version__, "python": platform.python_version()}
    for name in PACKAGES:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "not installed"
    model = ""
    cpu = Path("/proc/cpuinfo")
    if cpu.exists():
        lines = cpu.read_text(encoding="utf-8").splitlines()
        model = next((x.partition(":")[2].strip() for x in lines if x.startswith("model name")), "")
    return {
        "system": platform.platform(), "processor": model or platform.processor(),
        "processors": os.cpu_count(), "versions": versions,
    }  # fmt: skip
