"""The whole chain as it runs in use: a sender, ``igrip stream``, ``igrip drive`` and a device.

The sender, and the virtual device with its time stamps, are in the process that measures; the other
two are processes of their own, which faults can befall.
"""

from __future__ import annotations

import json
import re
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

from igrip.devices import DEVICES
from igrip.devices.base.settings import read_settings
from igrip.devices.base.twin import PtyServer
from igrip.errors import IgripError, requires_extra
from igrip.io.text import read_text
from igrip.lab.simulation.demo import DemoPerson
from igrip.objects.catalog import Catalog
from igrip.observation import Observation

START_TIMEOUT = 120.0  # s; the first start on a machine compiles
HAND = "right"
Mode = Literal["whole", "no hand", "silent"]


class Chain:
    """Two processes and a virtual device.

    Parameters
    ----------
    device : str
        Its name in the registry.
    config : Path
        Its configuration; the port in it is not used.
    catalog : Catalog
        Of the simulated person's objects.
    folder : Path
        For files of this run.
    options : sequence of str
        More options of ``igrip stream``.

    Attributes
    ----------
    sent : list of (float, bool)
        When each observation left [s], and whether its hand was there.
    received : list of (float, dict)
        When each intention of the hand came [s], and the message.
    """

    def __init__(
        self, device: str, config: Path, catalog: Catalog, folder: Path,
        options: tuple[str, ...] = (),
    ) -> None:  # fmt: skip
        self._device, self._catalog, self._folder = device, catalog, folder
        self._options = options
        kind = DEVICES.get(device)
        self.server = PtyServer(kind.new_twin(read_settings(kind.Settings, config), time.monotonic))
        self._config = folder / "device.toml"
        text = re.sub(r"(?m)^\s*(port|hand)\s*=.*$", "", read_text(config))
        self._config.write_text(
            f'port = "{self.server.path}"\nhand = "{HAND}"\n{text}', encoding="utf-8"
        )
        self.mode: Mode = "whole"
        self.befallen = 0.0  # when the fault came [s]
        self.sent: list[tuple[float, bool]] = []
        self.received: list[tuple[float, dict[str, Any]]] = []
        self.stream: subprocess.Popen[bytes] | None = None
        self.drive: subprocess.Popen[bytes] | None = None
        self._closed = threading.Event()
        self._threads: list[threading.Thread] = []
        self._person = _endless(catalog)

    def start(self) -> None:
        """Start both processes, and begin to send.

        Raises
        ------
        IgripError
            If one of them does not start.
        """
        with requires_extra("websockets", "outputs", "igrip certify"):
            from websockets.sync.client import connect
        with socket.socket() as trial:
            trial.bind(("127.0.0.1", 0))
            port = trial.getsockname()[1]
        address = f"ws://127.0.0.1:{port}"
        self.stream = _process(
            "stream", "--port", str(port), "--assisted", HAND, "--reliability", "0.3",
            *self._options,
        )  # fmt: skip
        out = self._wait(lambda: connect(f"{address}/observations", proxy=None), "igrip stream")
        into = connect(f"{address}/intentions", proxy=None)
        self.drive = _process(
            "drive", "--device", self._device, "--config", str(self._config), "--from", address,
            "--same-clock", "--arm", "--headless",
        )  # fmt: skip
        for work in (lambda: self._send(out), lambda: self._receive(into)):
            thread = threading.Thread(target=work, name="igrip-certify", daemon=True)
            self._threads.append(thread)
            thread.start()

    def _wait(self, connect: Callable[[], Any], name: str) -> Any:
        end = time.monotonic() + START_TIMEOUT
        while True:
            try:
                return connect()
            except OSError as error:
                ended = self.stream is not None and self.stream.poll() is not None
                if ended or time.monotonic() > end:
                    raise IgripError(f"{name} does not start: {error}") from error
                time.sleep(0.1)

    def _send(self, connection: Any) -> None:
        begin = time.monotonic()
        with suppress(Exception), connection:  # the other end is killed in some of the measurements
            for observation in self._person:
                wait = begin + observation.t - time.monotonic()
                if self._closed.wait(max(0.0, wait)):
                    return
                mode = self.mode
                if mode == "silent":
                    continue
                hands = dict(observation.hands) if mode == "whole" else {HAND: None}
                hands = {id: hand for id, hand in hands.items() if id == HAND}
                message = Observation(t=observation.t, hands=hands, objects=observation.objects)
                data = message.to_json().decode()
                self.sent.append((time.monotonic(), mode == "whole"))
                connection.send(data)

    def _receive(self, connection: Any) -> None:
        with suppress(Exception), connection:  # as above
            for data in connection:
                now = time.monotonic()
                message = json.loads(data)
                if message.get("hand") == HAND:
                    self.received.append((now, message))
                if self._closed.is_set():
                    return

    def last_good(self) -> float:
        """Return when the newest observation with a hand left [s]."""
        return next((t for t, good in reversed(self.sent) if good), 0.0)

    def wait_for_action(self, timeout: float) -> bool:
        """Wait until the device acts; False: it does not within ``timeout`` [s]."""
        return self._until(lambda: self.server.twin.outputs and self.active, timeout)

    def wait_for_stop(self, timeout: float) -> bool:
        """Wait until the device does nothing; False: it goes on."""
        return self._until(lambda: not self.active, timeout)

    @property
    def active(self) -> bool:
        """Whether the device acts."""
        outputs = self.server.twin.outputs
        return bool(outputs) and outputs[-1].active

    @staticmethod
    def _until(condition: Callable[[], object], timeout: float) -> bool:
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            if condition():
                return True
            time.sleep(0.001)
        return bool(condition())

    def close(self) -> None:
        """End everything."""
        self._closed.set()
        for process in (self.drive, self.stream):
            if process is not None:
                process.kill()
                process.wait()
        for thread in self._threads:
            thread.join(timeout=3.0)
        self.server.close()


def _endless(catalog: Catalog) -> Iterator[Observation]:
    for moment in DemoPerson(catalog, 0):
        yield moment.observation


def _process(*arguments: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "igrip", *arguments], stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
