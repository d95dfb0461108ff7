"""The page in the browser, by viser: what was decided, drawn beside the estimator.

The estimator hands over one moment at a time and never waits: while one is drawn, newer ones
replace each other, and the older are dropped and counted.
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
from igrip.errors import MissingExtraError
from igrip.viewer.choices import Choices
from igrip.viewer.drawing import SceneDrawing
from igrip.viewer.snapshot import Snapshot
from igrip.viewer.time_courses import CoursesPanels, courses_of

log = logging.getLogger(__name__)

HISTORY = 10.0  # seconds of time courses
MAX_MOMENTS = 1000  # kept for them, whatever the rate
COURSES_EVERY = 0.25  # seconds between two drawings of the time courses
KEY = (
    "Large spheres: hands. Small red ones: where a hand was; green: where it is expected in the "
    "next 0.3 s. Lines: rays towards the target; magenta: where they meet it."
)


class Viewer:
    """A page with the scene and the time courses.

    Parameters
    ----------
    host, port : str, int
        Where to listen; the next free port is taken where this one is not.
    targets : str, optional
        Name of the estimator that is at work.
    choose_targets : function, optional
        Called, from another thread, with the name that a person chooses on the page. Without it
        there is no such choice.

    Attributes
    ----------
    drawn, dropped : int
        Moments that were drawn (once more if another choice was made), and that were replaced by
        newer ones before they could be.

    Raises
    ------
    MissingExtraError
        If viser is not installed.
    """

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = 8080,
        targets: str | None = None,
        choose_targets: Callable[[str], None] | None = None,
    ) -> None:
        self._server: Any = open_server(host, port)
        self._newest: Snapshot | None = None
        self._history: deque[Snapshot] = deque(maxlen=MAX_MOMENTS)
        self._wake = threading.Condition()
        self._closed = False
        self.dropped = self.drawn = 0
        gui = self._server.gui
        self._note = gui.add_markdown("")
        self._words = gui.add_markdown("*no hand yet*")
        self._drawing = SceneDrawing(self._server)
        self._choices = Choices(self._server, targets, choose_targets, self._again)
        self._courses = CoursesPanels(self._server)
        gui.add_markdown(KEY)
        self._thread = threading.Thread(target=self._run, name="igrip-viewer", daemon=True)
        self._thread.start()

    @property
    def url(self) -> str:
        """Address of the page."""
        return f"http://localhost:{self._server.get_port()}"

    @property
    def server(self) -> Any:
        """The viser server, to add controls."""
        return self._server

    def show(self, moment: Snapshot) -> None:
        """Hand over the newest moment; returns at once."""
        with self._wake:
            if self._history and moment.t < self._history[-1].t:
                self._history.clear()
            self._history.append(moment)
            while moment.t - self._history[0].t > HISTORY:
                self._history.popleft()
            self._put(moment)

    def show_film(self, moments: Sequence[Snapshot], index: int) -> None:
        """Show one moment of a film, with the time courses up to it; returns at once."""
        first = index
        while first > max(0, index + 1 - MAX_MOMENTS) and (
            moments[index].t - moments[first - 1].t <= HISTORY
        ):
            first -= 1
        with self._wake:
            self._history.clear()
            self._history.extend(moments[first : index + 1])
            self._put(moments[index])

    def note(self, title: str, text: str) -> None:
        """Show a title and a line of text above the hands, for example the task of a demo."""
        self._note.content = f"### {plain(title)}\n{plain(text)}"

    def close(self) -> None:
        """Stop drawing and close the page's server."""
        with self._wake:
            self._closed = True
            self._wake.notify()
        self._thread.join(timeout=5.0)
        with quiet():
            self._server.stop()

    def _put(self, moment: Snapshot) -> None:
        self.dropped += self._newest is not None
        self._newest = moment
        self._wake.notify()

    def _again(self) -> None:
        """Draw the last moment again, since something else of it is wanted."""
        with self._wake:
            if self._history and self._newest is None:
                self._newest = self._history[-1]
                self._wake.notify()

    def _run(self) -> None:
        courses_due, stale = 0.0, False
        while True:
            with self._wake:
                self._wake.wait_for(
                    lambda: self._closed or self._newest is not None,
                    max(0.01, courses_due - time.monotonic()) if stale else None,
                )
                if self._closed:
                    return
                moment, self._newest = self._newest, None
                due = time.monotonic() >= courses_due
                history = list(self._history) if due else []
            stale = not due
            if due:
                courses_due = time.monotonic() + COURSES_EVERY
            try:
                with self._server.atomic():
                    if moment is not None:
                        self._draw(moment)
                        self.drawn += 1
                    self._draw_courses(history)
            except Exception:  # a moment that cannot be drawn must not end the page
                log.exception("a moment was not drawn")

    def _draw(self, moment: Snapshot) -> None:
        self._choices.offer([hand.intention.hand for hand in moment.hands])
        self._drawing.draw(moment, self._choices.rays, self._choices.hand)
        lines = [f"- {plain(describe(hand.intention))}" for hand in moment.hands]
        self._words.content = f"**t = {moment.t:.2f} s**\n\n" + "\n".join(lines)

    def _draw_courses(self, history: Sequence[Snapshot]) -> None:
        hand = self._choices.hand or _busiest(history)
        if hand is not None:
            courses = courses_of(history, hand)
            self._choices.offer_panels(list(courses.panels))
            self._courses.show(courses, self._drawing.colours, self._choices.hidden)


def _busiest(history: Sequence[Snapshot]) -> str | None:
    """Return the hand that reached last, or any."""
    hand = None
    for moment in reversed(history):
        for shown in moment.hands:
            if shown.intention.status in ("reaching", "holding"):
                return shown.intention.hand
            hand = hand or shown.intention.hand
    return hand


def plain(text: str) -> str:
    """Return text for markdown that shows as it is: ids and names come from outside."""
    return re.sub(r"([\\`*_{}\[\]()#+\-!|~>])", r"\\\1", escape(text, quote=False)).replace(
        "\n", " "
    )


def open_server(host: str, port: int) -> Any:
    """Return a viser server with the project's looks.

    Raises
    ------
    MissingExtraError
        If viser is not installed.
    """
    try:
        import viser
    except ImportError as error:
        raise MissingExtraError("viser", "viewer", "the scene in the browser") from error
    with quiet():
        server = viser.ViserServer(host, port, label="igrip", verbose=False)
    server.gui.configure_theme(show_logo=False, show_share_button=False, control_width="large")
    server.gui.set_panel_label("igrip")
    return server


@contextmanager
def quiet() -> Iterator[None]:
    """Keep viser's banners off standard output, where a program may read our answer."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
