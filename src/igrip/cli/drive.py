"""``igrip drive``: a device that acts on the leases of a running estimator."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from types import FrameType
from typing import Annotated, Any

import typer

from igrip.cli.console import errors, print_json, until_interrupted, warn
from igrip.cli.outputs import free_port
from igrip.devices import DEVICES, device_name
from igrip.devices.base.settings import TWIN, read_settings
from igrip.devices.base.twin import PtyServer
from igrip.drive.dry_run import DryRun
from igrip.drive.loop import DriveLoop, Order
from igrip.drive.page import DevicePage
from igrip.drive.receiver import Receiver
from igrip.drive.sources import open_source
from igrip.drive.supervisor import Say, Supervisor
from igrip.drive.user import FORMS, Keys, parse_signal

KEYS: dict[str, Order] = {"v": "veto", "c": "confirm", " ": "stop", "r": "resume"}


def drive(
    device: Annotated[
        str, typer.Option(help=f"The device: {', '.join(DEVICES.names()).replace('_', '-')}.")
    ],
    config: Annotated[
        Path, typer.Option(help="Its configuration, a TOML file: docs/devices.md.")
    ],
    source: Annotated[
        str,
        typer.Option("--from", help="Where intentions come from: ws://HOST:PORT of igrip stream or "
                     "live --out ws, or stdin."),
    ] = "ws://127.0.0.1:8765",
    arm: Annotated[
        bool, typer.Option("--arm", help="Let it act. Without this, it says what it would do.")
    ] = False,
    twin: Annotated[
        bool, typer.Option("--twin", help="Act on a virtual device, whatever port the file names.")
    ] = False,
    veto: Annotated[
        list[str] | None,
        typer.Option(help=f"What vetoes, besides the key v: {FORMS}; repeatable."),
    ] = None,
    confirm: Annotated[
        list[str] | None,
        typer.Option(help="What confirms, besides the key c; as --veto. The estimator needs "
                     "--confirm too."),
    ] = None,
    same_clock: Annotated[
        bool,
        typer.Option("--same-clock", help="The service runs on this machine: all of a message's "
                     "delay counts, not only what is more than usual."),
    ] = False,
    page_port: Annotated[
        int, typer.Option(help="Port of the page; 0: any that is free.", min=0, max=65535)
    ] = 8090,
    headless: Annotated[bool, typer.Option(help="No page in the browser.")] = False,
    seconds: Annotated[float | None, typer.Option(help="Default: until Ctrl-C.", min=0)] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON at the end.")] = False,
) -> None:  # fmt: skip
    """Let a device act on leases: dry by default, with --arm for real.

    Keys: v veto, c confirm, space stop, r resume after a stop or a fault.

    Example: igrip drive --device serial --config serial.toml

    Example, on a virtual device: igrip drive --device rehastim2 --config fes.toml --twin --arm
    """
    name = device_name(device)
    kind = DEVICES.get(name)
    settings = read_settings(kind.Settings, config)
    signals = {(text, order): parse_signal(text) for order, texts in (
        ("veto", veto or []), ("confirm", confirm or [])) for text in texts}  # fmt: skip
    opened = open_source(source, same_clock, warn)
    if not headless:
        page_port = free_port(page_port, "--page-port")
    clock = time.monotonic
    with ExitStack() as stack:
        acts: Any = DryRun(clock)
        if arm:
            if twin or settings.port == TWIN:
                server = PtyServer(kind.new_twin(settings, clock))
                stack.callback(server.close)
                settings = read_settings(kind.Settings, config, port=server.path)
            acts = kind(settings, clock)
        acts.open()

        def say(what: Say) -> None:
            opened.say({"control": what, "hand": settings.hand})

        supervisor = Supervisor(
            acts, settings.grip_names(), clock, settings.close_before, say,
            grip_for=settings.grip_for,
        )  # fmt: skip
        stack.callback(supervisor.close)
        loop = DriveLoop(supervisor, Receiver(settings.hand, clock, opened.same_clock), clock)
        keys = {key: _ordering(loop, order) for key, order in KEYS.items()}
        for (_, order), found in signals.items():
            if isinstance(found, str):
                keys[found] = _ordering(loop, order)
            else:
                found.start(_ordering(loop, order), warn)
                stack.callback(found.close)
        keyboard = Keys(keys)
        stack.callback(keyboard.close)
        keyboard.start()
        if not headless:
            page = DevicePage(loop, page_port, lambda: {"name": device, "armed": arm})
            stack.callback(page.close)
            errors.print(f"page: {page.url}", soft_wrap=True)
        how = "ARMED" if arm else "dry run (--arm to act)"
        errors.print(f"{device} for the {settings.hand} hand: {how}", soft_wrap=True)
        opened.start(loop)
        stack.callback(opened.close)
        before = signal.signal(signal.SIGTERM, _interrupt)
        stack.callback(signal.signal, signal.SIGTERM, before)
        printer = EventPrinter(supervisor, clock())
        with until_interrupted():
            loop.run(printer.print_new, None if seconds is None else clock() + seconds)
        supervisor.close()
        printer.print_new()
        if as_json and source != "stdin":
            print_json(loop.status())


def _ordering(loop: DriveLoop, order: Any) -> Callable[[], None]:
    return lambda: loop.order(order)


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


class EventPrinter:
    """Prints what the supervisor notes, a line each."""

    def __init__(self, supervisor: Supervisor, begin: float) -> None:
        self._supervisor, self._begin = supervisor, begin
        self._printed: tuple[float, str] | None = None

    def print_new(self) -> None:
        """Print what was noted since."""
        events = self._supervisor.events
        if not events or events[-1] is self._printed:
            return
        new = []
        for event in reversed(events):
            if event is self._printed:
                break
            new.append(event)
        self._printed = events[-1]
        for t, text in reversed(new):
            errors.print(f"{t - self._begin:8.3f} s  {text}", soft_wrap=True)
