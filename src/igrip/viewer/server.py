"""The page in the browser, by viser: the scene and the estimates, drawn beside the estimator.

The estimator hands over one snapshot at a time and never waits: while one is drawn, newer ones
replace each other, and those replaced are counted as dropped.
"""

from __future__ import annotations

import logging
import re
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from html import escape
from typing import Any

import rich

from igrip.describe import describe
from igrip.errors import requires_extra
from igrip.runtime.mailbox import Mailbox
from igrip.viewer.display_options import DisplayOptions
from igrip.viewer.drawing import SceneDrawing
from igrip.viewer.snapshot import Snapshot
from igrip.viewer.time_courses import CoursesPanels, courses_of

log = logging.getLogger(__name__)

HISTORY = 10.0  # seconds of time courses
MAX_SNAPSHOTS = 1000  # kept for the time courses, whatever the rate
COURSES_INTERVAL = 0.25  # seconds between two drawings of the time courses
KEY = (
    "Large spheres: hands. Small red ones: where a hand was; green: where it is expected in the "
    "next 0.3 s. Lines: rays towards the target; magenta: where they meet it."
)


class Page:
    """A page served by viser in the project's style.

    Parameters
    ----------
    host, port : str, int
        Address to listen on; if the port is not free, the next free one is used.

    Attributes
    ----------
    server : viser.ViserServer
        To add controls.

    Raises
    ------
    MissingExtraError
        If viser is not installed.
    """

    def __init__(self, host: str = "127.0.0.1", port: int = 8080) -> None:
        with requires_extra("viser", "viewer", "the scene in the browser"):
            import viser
        with quiet():
            self.server: Any = viser.ViserServer(host, port, label="igrip", verbose=False)
        gui = self.server.gui
        gui.configure_theme(show_logo=False, show_share_button=False, control_width="large")
        gui.set_panel_label("igrip")

    @property
    def url(self) -> str:
        """Address of the page."""
        return f"http://localhost:{self.server.get_port()}"

    def close(self) -> None:
        """Close the page's server."""
        with quiet():
            self.server.stop()


class Viewer(Page):
    """A page with the scene and the time courses.

    Parameters
    ----------
    host, port : str, int
        As of :class:`Page`.
    targets : str, optional
        Name of the current estimator.
    choose_targets : function, optional
        Called, from another thread, with the name of the estimator that a person chooses on the
        page. Without it the estimator cannot be changed.

    Attributes
    ----------
    drawn : int
        Snapshots that were drawn, some of them again after a change of the options.
    """

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = 8080,
        targets: str | None = None,
        choose_targets: Callable[[str], None] | None = None,
    ) -> None:
        super().__init__(host, port)
        self._waiting: Mailbox[Snapshot] = Mailbox()
        self._history: deque[Snapshot] = deque(maxlen=MAX_SNAPSHOTS)
        self._lock = threading.Lock()  # of the history; its last snapshot is the newest
        self.drawn = 0
        gui = self.server.gui
        self._note = gui.add_markdown("")
        self._summary = gui.add_markdown("*no hand yet*")
        self._drawing = SceneDrawing(self.server)
        self._options = DisplayOptions(self.server, targets, choose_targets, self._redraw)
        self._courses = CoursesPanels(self.server)
        gui.add_markdown(KEY)
        self._thread = threading.Thread(target=self._run, name="igrip-viewer", daemon=True)
        self._thread.start()

    @property
    def dropped(self) -> int:
        """Snapshots that newer ones replaced before they could be drawn."""
        return self._waiting.replaced

    def show(self, snapshot: Snapshot) -> None:
        """Show the newest snapshot; never blocks."""
        with self._lock:
            if self._history and snapshot.t < self._history[-1].t:
                self._history.clear()
            self._history.append(snapshot)
            while snapshot.t - self._history[0].t > HISTORY:
                self._history.popleft()
            self._waiting.put(snapshot)

    def show_replay(self, snapshots: Sequence[Snapshot], index: int) -> None:
        """Show one snapshot of a replay, with the time courses up to it; never blocks."""
        recent = snapshots[max(0, index + 1 - MAX_SNAPSHOTS) : index + 1]
        begin = snapshots[index].t - HISTORY
        with self._lock:
            self._history.clear()
            self._history.extend(snapshot for snapshot in recent if snapshot.t >= begin)
            self._waiting.put(snapshots[index])

    def note(self, title: str, text: str) -> None:
        """Show a title and a line of text above the hands, for example the task of a demo."""
        self._note.content = f"### {plain(title)}\n{plain(text)}"

    def close(self) -> None:
        """Stop drawing and close the page's server."""
        self._waiting.close()
        self._thread.join(timeout=5.0)
        super().close()

    def _redraw(self) -> None:
        """Draw the newest snapshot again, after a change of the options."""
        with self._lock:
            if self._history:
                self._waiting.get(timeout=0.0)  # the same one; it is not dropped
                self._waiting.put(self._history[-1])

    def _run(self) -> None:
        courses_due, stale = 0.0, False
        while True:
            wait = max(0.01, courses_due - time.monotonic()) if stale else None
            snapshot = self._waiting.get(wait)
            if snapshot is None and self._waiting.finished:
                return
            due = time.monotonic() >= courses_due
            stale = not due
            if due:
                courses_due = time.monotonic() + COURSES_INTERVAL
            try:
                with self.server.atomic():
                    if snapshot is not None:
                        self._draw(snapshot)
                        self.drawn += 1
                    if due:
                        self._draw_courses()
            except Exception:  # a snapshot that cannot be drawn must not end the page
                log.exception("a snapshot was not drawn")

    def _draw(self, snapshot: Snapshot) -> None:
        self._options.set_hands([hand.intention.hand for hand in snapshot.hands])
        self._drawing.draw(snapshot, self._options.rays, self._options.hand)
        lines = [f"- {plain(describe(hand.intention))}" for hand in snapshot.hands]
        self._summary.content = f"**t = {snapshot.t:.2f} s**\n\n" + "\n".join(lines)

    def _draw_courses(self) -> None:
        with self._lock:
            history = list(self._history)
        hand = self._options.hand or _last_reaching(history)
        if hand is not None:
            courses = courses_of(history, hand)
            self._options.add_panels(list(courses.panels))
            self._courses.show(courses, self._drawing.colours, self._options.hidden)


def _last_reaching(history: Sequence[Snapshot]) -> str | None:
    """Return the hand that reached last, or else any hand."""
    hand = None
    for snapshot in reversed(history):
        for shown in snapshot.hands:
            if shown.intention.status in ("reaching", "holding"):
                return shown.intention.hand
            hand = hand or shown.intention.hand
    return hand


def plain(text: str) -> str:
    """Return text escaped for markdown: ids and names come from outside."""
    return re.sub(r"([\\`*_{}\[\]()#+\-!|~>])", r"\\\1", escape(text, quote=False)).replace(
        "\n", " "
    )


@contextmanager
def quiet() -> Iterator[None]:
    """Keep viser's banners off standard output, where a program may read igrip's output."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
