"""The page of a review: list, speed profile, view from above, and video."""

from __future__ import annotations

import json
import threading
from collections.abc import Mapping
from importlib import resources
from typing import Any

from igrip.experiment.review import Review
from igrip.experiment.study import StudyError
from igrip.runtime.page_server import HTML, JPEG, JSON, PNG, Answer, PageServer


class ReviewPage(PageServer):
    """Serves a review.

    Parameters
    ----------
    review : Review
        What is shown and corrected; all recordings are read.
    port, host, token
        As of :class:`igrip.runtime.page_server.PageServer`.
    """

    def __init__(
        self, review: Review, port: int, host: str = "127.0.0.1", token: str | None = None
    ) -> None:
        self._review, self._lock = review, threading.Lock()
        self._film: tuple[str, list[tuple[float, bytes]]] = ("", [])  # of the newest one asked for
        html = resources.files(__package__).joinpath("pages", "review.html").read_bytes()
        pages = {"/": lambda: (HTML, html), "/recordings": self._list}
        super().__init__(pages, self._order, port, host, token, find=self._find)

    def _list(self) -> Answer:
        with self._lock:
            rows = [self._review.summary(one.trial.recording) for one in self._review]
        return JSON, json.dumps({"participant": self._review.participant, "rows": rows}).encode()

    def _find(self, path: str) -> Answer | None:
        """Return ``/recording/NAME`` or ``/picture/NAME/K``."""
        _, kind, *rest = path.split("/")
        try:
            if kind == "recording" and len(rest) == 1:
                return JSON, json.dumps(self._recording(rest[0])).encode()
            if kind == "picture" and len(rest) == 2 and rest[1].isdecimal():
                picture = self._pictures(rest[0])[int(rest[1])][1]
                return (PNG if picture.startswith(b"\x89PNG") else JPEG), picture
        except (StudyError, IndexError):
            pass
        return None

    def _recording(self, name: str) -> dict[str, Any]:
        with self._lock:
            one, row = self._review[name], self._review.summary(name)
        hand = zip(one.recorded.hand_times, one.recorded.hand_positions, strict=True)
        times = one.recorded.times
        return {
            **row, "automatic": one.automatic, "speeds": one.speeds, "objects": dict(one.objects),
            "times": [times[0], times[-1]] if times else [0, 1],
            "hand_positions": [[t, *position] for t, position in hand],
            "frames": [t for t, _ in self._pictures(name)],
        }  # fmt: skip

    def _pictures(self, name: str) -> list[tuple[float, bytes]]:
        with self._lock:
            if self._film[0] != name:
                self._film = (name, self._review.pictures(name))
            return self._film[1]

    def _order(self, path: str, values: Mapping[str, Any]) -> bool:
        name = str(values.get("recording", ""))
        with self._lock:
            if path == "/correct":
                try:
                    onset, end = float(values["onset_s"]), float(values["end_s"])
                except (KeyError, TypeError, ValueError):
                    raise StudyError("onset_s and end_s must be numbers") from None
                self._review.correct(name, onset, end)
            elif path == "/withdraw":
                self._review.withdraw(name)
            elif path == "/judge" and isinstance(values.get("performed"), bool):
                self._review.judge(name, values["performed"])
            else:
                return False
        return True
