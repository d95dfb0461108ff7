"""``igrip demo``: a simulated person reaches for the paper's four objects, before your eyes."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
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
    headless: Annotated[bool, typer.Option(help="No page in the browser.")] = False,
    duration: Annotated[
        float | None,
        typer.Option(help="Seconds of the scene. Default: one round of 16 reaches; endless with a "
                     "page and a terminal, until Ctrl-C.", min=0.0),
    ] = None,
    seed: Annotated[int, typer.Option(help="Another seed, another table.", min=0)] = 0,
    targets: Annotated[
        str | None, typer.Option(help="Targets estimator. Default: the library's.")
    ] = None,
    speed: Annotated[
        float, typer.Option(help="Times real time; 0: as fast as it goes.", min=0.0)
    ] = 1.0,
    port: Annotated[int, typer.Option(help="Port of the page.", min=1, max=65535)] = 8080,
    fault: Annotated[
        list[str] | None,
        typer.Option(help="What goes wrong: KIND@BEGIN+SECONDS or KIND:RATE[xSECONDS], such as "
                     f"freeze@3+0.5 or jump:0.2x0.1; repeatable. Kinds: {', '.join(KINDS)}."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON at the end.")
    ] = False,
) -> None:  # fmt: skip
    """Watch igrip decide what a simulated person reaches for, and with which grip.

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
    wanted = [config.targets]  # the page may ask for another
    viewer = None if headless else _open_viewer(config.targets, wanted.append, port)
    endless = viewer is not None and sys.stdout.isatty() and duration is None and not as_json
    tally = DemoScore()
    try:
        moments = _paced(_with(faults, _until(person, duration, endless), seed), speed)
        events = StatusChanges() if faults and not as_json else None
        _run(moments, _estimators(catalog, wanted), viewer, tally, as_json, events)
    except KeyboardInterrupt:
        errors.print("stopped")
    finally:
        if viewer is not None:
            viewer.close()
    if as_json:
        print_json(tally.summary())
    else:
        output.print(tally.sentence(), soft_wrap=True)


def _warm_up(person: DemoPerson, estimator: Estimator) -> None:
    """Compile before the clock runs."""
    for number, moment in enumerate(person):
        estimator.update(moment.observation)
        if number > 5:
            return


def _estimators(catalog: Catalog, wanted: list[str]) -> Iterator[Estimator]:
    """Give the estimator at work, again and again; a new one when another is wanted."""
    name = None
    while True:
        if wanted[-1] != name:
            name = wanted[-1]
            estimator = Estimator(catalog, Config(targets=name))
        yield estimator


def _open_viewer(targets: str, choose: Callable[[str], None], port: int) -> Viewer | None:
    try:
        viewer = Viewer(port=port, targets=targets, choose_targets=choose)
    except MissingExtraError as error:
        errors.print(f"{error}; going on without the page", style="yellow")
        return None
    errors.print(f"The scene is live at {viewer.url}")
    return viewer


def _until(person: DemoPerson, duration: float | None, endless: bool) -> Iterator[Moment]:
    tasks, task = 0, None
    for moment in person:
        if moment.task is not task:
            task, tasks = moment.task, tasks + 1
        if not endless and (tasks > person.round if duration is None else _over(moment, duration)):
            return
        yield moment


def _with(faults: list[Fault], moments: Iterator[Moment], seed: int) -> Iterator[Moment]:
    """Let things go wrong, if any are to."""
    if not faults:
        yield from moments
        return
    tasks: list[DemoTask] = []

    def source() -> Iterator[Observation]:
        for moment in moments:
            tasks[:] = [moment.task]
            yield moment.observation

    for observation in inject(source(), faults, seed):
        yield Moment(observation, tasks[0])


def _over(moment: Moment, duration: float) -> bool:
    return moment.observation.t >= duration


def _paced(moments: Iterator[Moment], speed: float) -> Iterator[Moment]:
    begin = time.perf_counter()
    for moment in moments:
        if speed:
            wait = begin + moment.observation.t / speed - time.perf_counter()
            if wait > 0.0:
                time.sleep(wait)
        yield moment


def _run(
    moments: Iterator[Moment],
    estimators: Iterator[Estimator],
    viewer: Viewer | None,
    tally: DemoScore,
    quiet: bool,
    events: StatusChanges | None,
) -> None:
    live = Live(console=output, refresh_per_second=15, transient=True)
    on_screen = output.is_terminal and not quiet
    if on_screen:
        live.start()
    try:
        task: DemoTask | None = None
        for moment, estimator in zip(moments, estimators, strict=False):
            if moment.task is not task:
                task = moment.task
                if viewer is not None:
                    viewer.note("Task", _task_words(task))
            intentions = estimator.update(moment.observation)
            line = tally.update(moment, intentions)
            for event in events.update(intentions) if events else ():
                output.print(event, soft_wrap=True)
            if viewer is not None:
                viewer.show(take_snapshot(estimator))
            if on_screen:
                live.update(_screen(moment, intentions, tally))
            if line and not quiet:
                output.print(line, soft_wrap=True)
    finally:
        if on_screen:
            live.stop()


def _task_words(task: DemoTask) -> str:
    return f"{task.hand} hand to {task.target}, {task.grip} grip"


def _screen(moment: Moment, intentions: list[Intention], tally: DemoScore) -> Table:
    table = Table(title=f"t = {moment.observation.t:6.2f} s   task: {_task_words(moment.task)}")
    for column in ("hand", "status", "target", "grip", "score", "contact in", "may act on"):
        table.add_column(column, min_width=9)
    for intention in intentions:
        own = intention.hand == moment.task.hand and intention.status == "reaching"
        right = intention.target == moment.task.target
        colour = ("green" if right else "red") if own else "dim"
        table.add_row(
            intention.hand,
            intention.status,
            Text(intention.target or "-", colour),
            intention.grip or "-",
            "-" if intention.confidence is None else f"{intention.confidence:.2f}",
            "-" if intention.time_to_contact is None else f"{intention.time_to_contact:.2f} s",
            intention.commitment.target if intention.commitment else "-",
        )
    own_words = [describe(i) for i in intentions if i.hand == moment.task.hand]
    table.caption = "\n".join([*own_words, tally.sentence()])
    return table
