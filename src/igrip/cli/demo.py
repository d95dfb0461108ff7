"""``igrip demo``: a simulated person reaches for the paper's four objects, live."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from itertools import chain, islice
from typing import Annotated

import typer
from rich.live import Live
from rich.table import Table
from rich.text import Text

from igrip.cli.console import errors, output, print_json
from igrip.config import Config
from igrip.describe import describe
from igrip.errors import MissingExtraError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.lab.simulation.demo import DemoPerson, DemoTask, Moment
from igrip.lab.simulation.demo_score import DemoScore, StatusChanges
from igrip.lab.simulation.faults import KINDS, Fault, inject
from igrip.objects.catalog import Catalog, load_objects
from igrip.observation import Observation
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import take_snapshot


def demo(
    headless: Annotated[bool, typer.Option(help="Open no page in the browser.")] = False,
    duration: Annotated[
        float | None,
        typer.Option(help="Seconds of the scene. Default: one round of 16 reaches; with a page and "
                     "a terminal, until Ctrl-C.", min=0.0),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the table and of the noise.", min=0)] = 0,
    targets: Annotated[
        str | None, typer.Option(help="Targets estimator. Default: the library's.")
    ] = None,
    speed: Annotated[
        float, typer.Option(help="Multiple of real time; 0: as fast as possible.", min=0.0)
    ] = 1.0,
    port: Annotated[int, typer.Option(help="Port of the page.", min=1, max=65535)] = 8080,
    fault: Annotated[
        list[str] | None,
        typer.Option(help="A sensor fault: KIND@BEGIN+SECONDS or KIND:RATE[xSECONDS], such as "
                     f"freeze@3+0.5 or jump:0.2x0.1; repeatable. Kinds: {', '.join(KINDS)}."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON at the end.")
    ] = False,
) -> None:  # fmt: skip
    """Watch igrip predict what a simulated person reaches for, and with which grip.

    The scene is live in the terminal and, unless --headless, in the browser.

    Example: igrip demo --headless --duration 20 --seed 3

    Example: igrip demo --fault lose@2+0.4 --fault jump:0.3
    """
    faults = [Fault.parse(text) for text in fault or []]
    config = Config(targets=targets) if targets else Config()
    with errors.status("Reading meshes, compiling the geometry (some seconds the first time) …"):
        catalog = load_objects("ycb")
        person = DemoPerson(catalog, seed)
        _warm_up(person, Estimator(catalog, config))
    choices = [config.targets]  # the page appends another estimator's name
    viewer = None if headless else _open_viewer(config.targets, choices.append, port)
    endless = viewer is not None and sys.stdout.isatty() and duration is None and not as_json
    moments = iter(person) if endless else _limited(person, duration)
    if faults:
        moments = _with_faults(moments, faults, seed)
    score = DemoScore()
    events = StatusChanges() if faults and not as_json else None
    try:
        _run(_paced(moments, speed), _estimators(catalog, choices), viewer, score, as_json, events)
    except KeyboardInterrupt:
        errors.print("stopped")
    finally:
        if viewer is not None:
            viewer.close()
    if as_json:
        print_json(score.summary())
    else:
        output.print(score.sentence(), soft_wrap=True)


def _warm_up(person: DemoPerson, estimator: Estimator) -> None:
    """Compile before the clock runs."""
    for moment in islice(person, 7):
        estimator.update(moment.observation)


def _estimators(catalog: Catalog, choices: list[str]) -> Iterator[Estimator]:
    """Yield the estimator for each message; a new one after another was chosen."""
    name = None
    while True:
        if choices[-1] != name:
            name = choices[-1]
            estimator = Estimator(catalog, Config(targets=name))
        yield estimator


def _open_viewer(targets: str, choose: Callable[[str], None], port: int) -> Viewer | None:
    try:
        viewer = Viewer(port=port, targets=targets, choose_targets=choose)
    except MissingExtraError as error:
        errors.print(f"{error}; continuing without the page", style="yellow")
        return None
    errors.print(f"The scene is live at {viewer.url}")
    return viewer


def _limited(person: DemoPerson, duration: float | None) -> Iterator[Moment]:
    """Yield the moments of a duration [s], or of one round of tasks."""
    tasks: set[float] = set()
    for moment in person:
        tasks.add(moment.task.begin)
        ended = len(tasks) > person.round if duration is None else moment.observation.t >= duration
        if ended:
            return
        yield moment


def _with_faults(moments: Iterator[Moment], faults: list[Fault], seed: int) -> Iterator[Moment]:
    """Yield the moments with sensor faults in their observations."""
    first = next(moments, None)
    if first is None:
        return
    task = first.task

    def observations() -> Iterator[Observation]:
        nonlocal task
        for moment in chain([first], moments):
            task = moment.task
            yield moment.observation

    for observation in inject(observations(), faults, seed):
        yield Moment(observation, task)


def _paced(moments: Iterator[Moment], speed: float) -> Iterator[Moment]:
    """Yield each moment when it is due, at a multiple of real time; 0: at once."""
    begin = time.perf_counter()
    for moment in moments:
        if speed:
            time.sleep(max(0.0, begin + moment.observation.t / speed - time.perf_counter()))
        yield moment


def _run(
    moments: Iterator[Moment],
    estimators: Iterator[Estimator],
    viewer: Viewer | None,
    score: DemoScore,
    quiet: bool,
    events: StatusChanges | None,
) -> None:
    live = Live(console=output, refresh_per_second=15, transient=True)
    on_screen = output.is_terminal and not quiet
    task: DemoTask | None = None
    with live if on_screen else nullcontext():
        for moment, estimator in zip(moments, estimators, strict=False):
            if viewer is not None and moment.task is not task:
                task = moment.task
                viewer.note("Task", _summary(task))
            intentions = estimator.update(moment.observation)
            line = score.update(moment, intentions)
            for event in events.update(intentions) if events else ():
                output.print(event, soft_wrap=True)
            if viewer is not None:
                viewer.show(take_snapshot(estimator))
            if on_screen:
                live.update(_table(moment, intentions, score))
            if line and not quiet:
                output.print(line, soft_wrap=True)


def _summary(task: DemoTask) -> str:
    return f"{task.hand} hand to {task.target}, {task.grip} grip"


def _table(moment: Moment, intentions: list[Intention], score: DemoScore) -> Table:
    """Return the live table: one row per hand, the task's hand in colour."""
    table = Table(title=f"t = {moment.observation.t:6.2f} s   task: {_summary(moment.task)}")
    for column in ("hand", "status", "target", "grip", "score", "contact in", "permission for"):
        table.add_column(column, min_width=9)
    for intention in intentions:
        of_task = intention.hand == moment.task.hand and intention.status == "reaching"
        correct = intention.target == moment.task.target
        colour = ("green" if correct else "red") if of_task else "dim"
        table.add_row(
            intention.hand,
            intention.status,
            Text(intention.target or "-", colour),
            intention.grip or "-",
            "-" if intention.confidence is None else f"{intention.confidence:.2f}",
            "-" if intention.time_to_contact is None else f"{intention.time_to_contact:.2f} s",
            intention.commitment.target if intention.commitment else "-",
        )
    sentences = [describe(i) for i in intentions if i.hand == moment.task.hand]
    table.caption = "\n".join([*sentences, score.sentence()])
    return table
