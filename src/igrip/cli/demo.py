"""``igrip demo``: a simulated person reaches for the paper's four objects, live."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, nullcontext, suppress
from queue import Empty, SimpleQueue
from typing import Annotated

import typer
from rich.live import Live
from rich.text import Text

from igrip.cli import estimator_setup as setup
from igrip.cli import options
from igrip.cli.console import errors, number, output, print_json, table_of, until_interrupted
from igrip.cli.device_option import device_process
from igrip.cli.outputs import free_port
from igrip.cli.page import open_page
from igrip.cli.table import FoldingTable
from igrip.config import Config
from igrip.describe import describe
from igrip.drive.process import DeviceProcess
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.lab.simulation.demo import DemoPerson, DemoTask, Moment
from igrip.lab.simulation.demo_score import DemoScore, StatusChanges
from igrip.lab.simulation.faults import KINDS, Fault, inject
from igrip.objects.catalog import Catalog, load_objects
from igrip.observation import Observation
from igrip.runtime.envelope import Sequencer
from igrip.runtime.protocol import Command
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import take_snapshot


def demo(
    headless: Annotated[bool, typer.Option(help="Open no page in the browser.")] = False,
    duration: Annotated[
        float | None,
        typer.Option(help="Seconds of the scene. Default: one round of 16 reaches; with a page and "
                     "a terminal, until Ctrl-C.", min=0.0),
    ] = None,
    seed: options.Seed = 0,
    targets: options.Targets = None,
    speed: Annotated[
        float, typer.Option(help="Multiple of real time; 0: as fast as possible.", min=0.0)
    ] = 1.0,
    port: options.PagePort = 8080,
    fault: Annotated[
        list[str] | None,
        typer.Option(help="A sensor fault: KIND@BEGIN+SECONDS or KIND:RATE[xSECONDS], such as "
                     f"freeze@3+0.5 or jump:0.2x0.1; repeatable. Kinds: {', '.join(KINDS)}."),
    ] = None,
    device: options.Device = None,
    device_config: options.DeviceConfig = None,
    arm: options.Arm = False,
    twin: options.Twin = False,
    as_json: options.Json = False,
) -> None:  # fmt: skip
    """Watch igrip predict what a simulated person reaches for, and with which grip.

    The scene is live in the terminal and, unless --headless, in the browser.

    Example: igrip demo --headless --duration 20 --seed 3

    Example: igrip demo --fault lose@2+0.4 --fault jump:0.3

    Example: igrip demo --device serial --device-config serial.toml --twin --arm
    """
    commands: SimpleQueue[Command] = SimpleQueue()  # from the page and from the device's user
    process = device_process(device, device_config, arm, twin, headless, commands.put)
    faults = [Fault.parse(text) for text in fault or []]
    config = setup.estimator_config(targets)
    if not headless:
        port = free_port(port)
    with errors.status("Reading meshes, compiling the geometry (some seconds the first time) …"):
        catalog = load_objects("ycb")
        setup.warm_up(config, catalog)
    choices = [config.targets]  # the page appends another estimator's name
    viewer = None if headless else open_page(
        port, targets=config.targets, choose_targets=choices.append, on_command=commands.put
    )  # fmt: skip
    endless = viewer is not None and sys.stdout.isatty() and duration is None and not as_json
    person = DemoPerson(catalog, seed)
    moments = iter(person) if endless else _limited(person, duration)
    if faults:
        moments = _with_faults(moments, faults, seed)
    score = DemoScore()
    events = StatusChanges() if faults and not as_json else None
    with ExitStack() as stack:
        act = None
        if process is not None:
            process.start()
            stack.callback(process.close)
            act = DemoDevice(process, commands).update
        stack.enter_context(closing(viewer) if viewer is not None else nullcontext())
        with until_interrupted():
            _run(
                _paced(moments, speed), _estimators(catalog, choices, commands), viewer, score,
                as_json, events, act,
            )  # fmt: skip
    if as_json:
        print_json(score.summary())
    else:
        output.print(score.sentence(), soft_wrap=True)


class DemoDevice:
    """Sends the intentions of the demo to a device, and applies what its user commands."""

    def __init__(self, process: DeviceProcess, commands: SimpleQueue[Command]) -> None:
        self._process, self._commands = process, commands
        self._sequencer = Sequencer(time.monotonic)

    def update(self, estimator: Estimator, intentions: list[Intention]) -> None:
        """Send them; each permits as much as its lease has left at that moment."""
        while not self._commands.empty():
            with suppress(IgripError):  # the hand is not known yet
                intentions = [*intentions, *self._commands.get().apply(estimator)]
        with suppress(BrokenPipeError):  # the device's process has ended
            for intention in intentions:
                self._process.send(self._sequencer.wrap(intention, time.monotonic()))


def _estimators(
    catalog: Catalog, choices: list[str], commands: SimpleQueue[Command]
) -> Iterator[Estimator]:
    """Yield the estimator for each message, after commands; a new one after another was chosen."""
    name = None
    while True:
        if choices[-1] != name:
            name = choices[-1]
            estimator = Estimator(catalog, Config(targets=name))
        with suppress(Empty):
            while True:
                command = commands.get_nowait()
                with suppress(IgripError):  # of a hand that is unknown by now
                    command.apply(estimator)
        yield estimator


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
    tasks: list[DemoTask] = []

    def observations() -> Iterator[Observation]:
        for moment in moments:
            tasks[:] = [moment.task]
            yield moment.observation

    for observation in inject(observations(), faults, seed):
        yield Moment(observation, tasks[0])


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
    act: Callable[[Estimator, list[Intention]], None] | None = None,
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
            if act is not None:
                act(estimator, intentions)
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


def _table(moment: Moment, intentions: list[Intention], score: DemoScore) -> FoldingTable:
    """Return the live table: one row per hand, the task's hand in colour."""
    rows = []
    for intention in intentions:
        of_task = intention.hand == moment.task.hand and intention.status == "reaching"
        correct = intention.target == moment.task.target
        colour = ("green" if correct else "red") if of_task else "dim"
        cells = (
            intention.hand,
            intention.status,
            Text(intention.target or "-", colour),
            intention.grip or "-",
            number(intention.confidence),
            number(intention.time_to_contact, unit=" s"),
            intention.commitment.target if intention.commitment else "-",
        )
        rows.append(cells)
    columns = ("hand", "status", "target", "grip", "score", "contact in", "permission for")
    sentences = [describe(i) for i in intentions if i.hand == moment.task.hand]
    title = f"t = {moment.observation.t:6.2f} s   task: {_summary(moment.task)}"
    caption = "\n".join([*sentences, score.sentence()])
    return table_of(columns, rows, title, caption, left=(1, 2, 3, 6))
