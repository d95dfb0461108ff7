"""The page in the browser: what igrip thinks of each hand, drawn beside the estimator.

The estimator hands over one snapshot at a time and never waits: while one is drawn, newer ones
replace each other, and those replaced are counted as dropped. What was decided for each hand is
kept of every snapshot, so that the charts have no holes.
"""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from igrip.errors import requires_extra
from igrip.geometry.scene import PlacedObject
from igrip.objects.model import ObjectModel
from igrip.runtime.mailbox import Mailbox
from igrip.runtime.protocol import ACTIONS, Command
from igrip.targets import TARGETS
from igrip.version import __version__
from igrip.viewer.page_messages import encode_mesh, row_of_hand, scene_of
from igrip.viewer.palette import Looks
from igrip.viewer.snapshot import Snapshot

log = logging.getLogger(__name__)

LIVE_ROWS = 2000  # kept for a page that is opened later
MAX_PENDING = 10_000  # rows that wait to be sent
INTERVAL = 1.0 / 30.0  # s between two drawings


class Viewer:
    """The page: sentences, probabilities, leases, the scene and the charts.

    Parameters
    ----------
    host, port : str, int
        Address to listen on; port 0: any that is free.
    targets : str, optional
        Name of the current estimator.
    choose_targets : function, optional
        Called, from another thread, with the name of the estimator that a person chooses on the
        page. Without it the estimator cannot be changed.
    on_command : function, optional
        Called, from another thread, with the commands about leases that a person gives (veto,
        confirm). Without it the page has no such buttons.

    Attributes
    ----------
    drawn : int
        Snapshots that were drawn.
    looks : Looks
        The letters and colours of the objects.

    Raises
    ------
    MissingExtraError
        If a package for the page is not installed.
    """

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = 8080,
        targets: str | None = None,
        choose_targets: Callable[[str], None] | None = None,
        on_command: Callable[[Command], None] | None = None,
    ) -> None:
        with requires_extra("websockets", "viewer", "the page in the browser"):
            from igrip.viewer.page_server import PageServer
        self._choose_targets, self._on_command = choose_targets, on_command
        self._handlers: dict[str, Callable[[Any], None]] = {}
        self._setup: dict[str, Any] = {
            "version": __version__, "mode": "live", "targets": targets,
            "choices": list(TARGETS.names()) if targets and choose_targets else [],
            "commands": list(ACTIONS) if on_command else [],
        }  # fmt: skip
        self._waiting: Mailbox[Snapshot] = Mailbox()
        self._pending: deque[dict[str, Any]] = deque(maxlen=MAX_PENDING)
        self._lock = threading.Lock()  # of what is pending
        self._restart = False
        self._last_t = float("-inf")
        self._meshes: dict[str, int] = {}
        self._drawn: dict[str, ObjectModel] = {}
        self._mesh_count = -1
        self.drawn, self.looks = 0, Looks()
        self._server = PageServer(host, port, self._receive)
        self._server.publish("setup", self._setup)
        self._thread = threading.Thread(target=self._run, name="igrip-viewer", daemon=True)
        self._thread.start()

    @property
    def url(self) -> str:
        """Address of the page."""
        return self._server.url

    @property
    def dropped(self) -> int:
        """Snapshots that newer ones replaced before they could be drawn."""
        return self._waiting.replaced

    def show(self, snapshot: Snapshot) -> None:
        """Show the newest snapshot; never blocks."""
        with self._lock:
            if snapshot.t < self._last_t:
                self._pending.clear()
                self._restart = True
            self._last_t = snapshot.t
            self._pending.extend(rows_of(snapshot))
        self._waiting.put(snapshot)

    def show_recording(self, snapshots: Sequence[Snapshot]) -> None:
        """Show the time courses of a whole recording; :meth:`show_moment` selects its moment."""
        rows = [row for snapshot in snapshots for row in rows_of(snapshot)]
        self._name(snapshots)
        self._server.add_rows(rows, reset=True)

    def show_moment(self, snapshot: Snapshot) -> None:
        """Show one moment of a recording; never blocks."""
        self._waiting.put(snapshot)

    def note(self, title: str, text: str) -> None:
        """Show a title and a line of text at the top, for example the task of a demo."""
        self._server.publish("note", {"title": title, "text": text})

    def publish(self, kind: str, message: Mapping[str, Any], key: str | None = None) -> None:
        """Send the page a message; it replaces those of its kind and key; never blocks."""
        self._server.publish(kind, message, key)

    def set_up(self, **changes: Any) -> None:
        """Change how the page is set up, such as its ``mode``."""
        self._setup |= changes
        self._server.publish("setup", self._setup)

    def add_resource(self, path: str, content_type: str, data: bytes) -> None:
        """Serve bytes under a path."""
        self._server.add_resource(path, content_type, data)

    def handle(self, name: str, handler: Callable[[Any], None]) -> None:
        """Have a function called, from another thread, with what a page sends under a name."""
        self._handlers[name] = handler

    def close(self) -> None:
        """Stop drawing and close the page."""
        self._waiting.close()
        self._thread.join(timeout=5.0)
        self._server.close()

    def _receive(self, message: dict[str, Any]) -> None:
        """Do what a person asks on the page; what no button sends is ignored."""
        action, hand = message.get("control"), message.get("hand")
        if action in ACTIONS and self._on_command and isinstance(hand, str):
            self._on_command(Command(action, hand))
        chosen = message.get("targets")
        if self._choose_targets is not None and chosen in self._setup["choices"]:
            self._choose_targets(str(chosen))
            self.set_up(targets=chosen)
        for name, handler in self._handlers.items():
            if name in message:
                try:
                    handler(message[name])
                except (TypeError, ValueError, LookupError):
                    log.warning("the page sent %.200r", message)

    def _run(self) -> None:
        while True:
            snapshot = self._waiting.get()
            if snapshot is None:
                if self._waiting.finished:
                    return
                continue
            begin = time.monotonic()
            try:
                if self._setup["mode"] == "live":
                    self._name([snapshot])
                self._send_rows()
                self._draw(snapshot)
                self.drawn += 1
            except Exception:  # a snapshot that cannot be drawn must not end the page
                log.exception("a snapshot was not drawn")
            time.sleep(max(0.0, begin + INTERVAL - time.monotonic()))

    def _send_rows(self) -> None:
        with self._lock:
            rows, restart = list(self._pending), self._restart
            self._pending.clear()
            self._restart = False
        if rows or restart:
            self._server.add_rows(rows, reset=restart)
        if self._setup["mode"] == "live":
            self._server.keep_rows(LIVE_ROWS)

    def _name(self, snapshots: Sequence[Snapshot]) -> None:
        """Give each object its letter and colour."""
        known = {placed.id for snapshot in snapshots for placed in snapshot.objects}
        live = self._setup["mode"] == "live"
        if known and self.looks.update(known, snapshots[-1].t if live else 0.0):
            self._server.publish("looks", {"numbers": self.looks.numbers()})

    def _draw(self, snapshot: Snapshot) -> None:
        for placed in snapshot.objects:
            self._add_mesh(placed)
        self._server.publish("scene", scene_of(snapshot, self._meshes))

    def _add_mesh(self, placed: PlacedObject) -> None:
        model = placed.model
        if self._drawn.get(model.name) is not model:  # new, or refined since
            self._drawn[model.name] = model
            number = self._mesh_count = self._mesh_count + 1
            data = encode_mesh(model.vertices, model.faces)
            self._server.add_resource(f"/mesh/{number}", "application/octet-stream", data)
            self._meshes[model.name] = number


def rows_of(snapshot: Snapshot) -> list[dict[str, Any]]:
    """Return a row for each hand whose intention is of this snapshot, not of an earlier one."""
    return [row_of_hand(hand) for hand in snapshot.hands if hand.intention.t == snapshot.t]
