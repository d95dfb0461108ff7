"""The time courses of the paper's Figure 6: speed, confidences, global score, target and grip."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.lab.evaluation.time_courses import (
    GRIP,
    GRIPS,
    SPEED,
    TARGET,
    TimeCourses,
    time_courses,
)
from igrip.viewer.grip_zones import PALMAR, PINCH
from igrip.viewer.snapshot import Snapshot

Array = NDArray[np.float64]
MAX_OBJECTS = 8  # lines in a panel
GRIP_COLOURS = (PALMAR, PINCH)


def courses_of(moments: Sequence[Snapshot], hand: str) -> TimeCourses:
    """Gather the time courses of one hand from the successive moments at which it was answered."""
    own = [
        shown for moment in moments for shown in moment.hands
        if shown.intention.hand == hand and shown.intention.t == moment.t
    ]  # fmt: skip
    speeds = [np.nan if shown.motion is None else shown.motion.speed for shown in own]
    return time_courses([shown.intention for shown in own], speeds, MAX_OBJECTS)


class CoursesPanels:
    """The panels on the page, one below the other."""

    def __init__(self, server: Any) -> None:
        self._gui = server.gui
        self._folder = self._gui.add_folder("Time courses")
        with self._folder:
            self._key = self._gui.add_html("")
        self._plots: dict[str, Any] = {}
        self._lines: tuple[str, ...] = ()
        self._fastest = 1.0  # upper end of the speed panel [m/s]

    def show(
        self,
        courses: TimeCourses,
        colours: Mapping[str, tuple[int, int, int]],
        hidden: Sequence[str] = (),
    ) -> None:
        """Draw time courses in the colours of the objects, but for the hidden panels."""
        if self._lines != (*courses.objects, *courses.panels):
            self._begin(courses, colours)
        for name, plot in self._plots.items():
            plot.visible = name not in hidden
            if plot.visible:
                if name == SPEED:
                    self._widen(plot, courses.panels[name])
                plot.data = (courses.times, *courses.panels[name])

    def _widen(self, plot: Any, speeds: Array) -> None:
        """Make room for the highest speed; what is NaN leaves no room to choose by itself."""
        highest = float(np.nan_to_num(speeds).max(initial=0.0))
        if highest > self._fastest:
            self._fastest = 0.5 * math.ceil(highest / 0.5)
            plot.scales = {"x": {"time": False}, "y": _range(SPEED, 1, self._fastest)}

    def _begin(self, courses: TimeCourses, colours: Mapping[str, tuple[int, int, int]]) -> None:
        """Make the panels anew, since there are other objects or scores."""
        for plot in self._plots.values():
            plot.remove()
        self._plots.clear()
        names = {id: _css(colours.get(id, (120, 120, 120))) for id in courses.objects}
        keys = [(colour, escape(id)) for id, colour in names.items()]
        keys += [(_css(c), g) for c, g in zip(GRIP_COLOURS, GRIPS, strict=True)]
        self._key.content = "<div style='font-size:0.8em;padding:0 1em'>" + " &ensp;".join(
            f"<span style='color:{colour}'>&#9632;</span> {text}" for colour, text in keys
        ) + "</div>"  # fmt: skip
        with self._folder:
            for name, rows in courses.panels.items():
                if not len(rows):  # no object, no line
                    continue
                strokes = {SPEED: ["rgb(60,60,60)"], GRIP: list(map(_css, GRIP_COLOURS))}.get(
                    name, list(names.values())
                )
                self._plots[name] = self._gui.add_uplot(
                    (courses.times, *rows),
                    ({"label": "t [s]"}, *(_series(stroke, name) for stroke in strokes)),
                    title=name.replace("_", " "),
                    height=92,
                    scales={"x": {"time": False}, "y": _range(name, len(rows), self._fastest)},
                    axes=(
                        {"size": 24, "space": 60},
                        {"size": 34, "space": 18, "show": name not in (TARGET, GRIP)},
                    ),
                    legend={"show": False},
                    padding=(0, 8, 0, 0 if name not in (TARGET, GRIP) else 34),
                )
        self._lines = (*courses.objects, *courses.panels)


def _series(stroke: str, name: str) -> Any:
    marks = name in (TARGET, GRIP)
    return {
        "stroke": stroke, "width": 5 if marks else 1.5, "spanGaps": False,
        "points": {"show": False},
    }  # fmt: skip


def _range(name: str, lines: int, fastest: float) -> Any:
    if name == SPEED:
        return {"auto": False, "range": (0.0, fastest)}
    if name in (TARGET, GRIP):
        return {"auto": False, "range": (0.0, lines + 1.0)}
    lowest = -1.05 if name == "distance_derivative" else -0.05
    return {"auto": False, "range": (lowest, 1.05)}


def _css(colour: tuple[int, ...]) -> str:
    return f"rgb({colour[0]},{colour[1]},{colour[2]})"
