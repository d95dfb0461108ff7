"""``igrip live``: a camera, and what each hand in its picture is about to grasp."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated, Any
from urllib.parse import parse_qsl

import typer
from rich.live import Live

from igrip.cli.console import errors, output, print_json
from igrip.cli.live_table import markdown_of, table_of
from igrip.cli.stream import Out, warm_up
from igrip.commitment import ALL_HANDS, CommitmentConfig
from igrip.config import Config
from igrip.errors import IgripError, MissingExtraError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.io.recordings.files import open_writer
from igrip.objects.catalog import PAPER_OBJECTS, load_objects
from igrip.perception.cameras import Camera, open_camera, split_names
from igrip.perception.pipeline.detectors import hand_eye, object_eye, read_options, warm_up_eyes
from igrip.perception.pipeline.pipeline import Pipeline
from igrip.runtime.access import Access
from igrip.runtime.loop import Loop
from igrip.runtime.outputs.stdout import StdoutOutput
from igrip.viewer.camera_panel import PicturePanel, Seen
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import take_snapshot

SCREEN_EVERY = 0.5  # s
NOTHING = "none"


def live(
    camera: Annotated[
        str,
        typer.Option(help="oak, realsense, webcam:0, replay:FILE.mcap, rendered; several joined by "
                     "+, as in oak:ID1+oak:ID2."),
    ] = "oak",
    hands: Annotated[str, typer.Option(help="Hand finder; none: no hands.")] = "mediapipe",
    objects: Annotated[
        str, typer.Option(help="Pose finder: depth, tags, cosypose; none: no objects.")
    ] = "depth",
    model: Annotated[
        list[str] | None,
        typer.Option(help="A model that may be on the table; repeatable. Default: the paper's "
                     "four."),
    ] = None,
    catalog: Annotated[
        list[str] | None, typer.Option(help="Where models come from. Default: ycb.")
    ] = None,
    option: Annotated[
        list[str] | None,
        typer.Option(help="NAME=VALUE for the pose finder, such as tags=tags.toml; repeatable."),
    ] = None,
    calibration: Annotated[
        Path | None, typer.Option(help="Where the cameras stand: a file of igrip calibrate.")
    ] = None,
    apart: Annotated[
        bool, typer.Option("--apart", help="Keep the hands of several cameras apart, by camera.")
    ] = False,
    max_hands: Annotated[int, typer.Option(help="Hands looked for.", min=1, max=4)] = 2,
    out: Annotated[
        Path | None,
        typer.Option(help="Record what the estimator is given: F.jsonl or F.mcap; igrip replay "
                     "gives the same intentions again."),
    ] = None,
    tell: Annotated[
        list[Out] | None, typer.Option(help="Where intentions go; repeatable.")
    ] = None,
    targets: Annotated[str | None, typer.Option(help="Targets estimator.")] = None,
    assisted: Annotated[
        list[str] | None, typer.Option(help="A hand that a device assists. Default: every hand.")
    ] = None,
    reliability: Annotated[
        float, typer.Option(help="0: commit early; 1: late, or not at all.", min=0.0, max=1.0)
    ] = CommitmentConfig().reliability,
    confirm: Annotated[
        bool, typer.Option("--confirm", help="Commit to what is confirmed from outside only.")
    ] = False,
    seconds: Annotated[
        float | None, typer.Option(help="Default: until Ctrl-C, or the end of a recording.", min=0)
    ] = None,
    headless: Annotated[bool, typer.Option(help="No page in the browser.")] = False,
    page_port: Annotated[int, typer.Option(help="Port of the page.", min=1, max=65535)] = 8080,
    host: Annotated[str, typer.Option(help="Address of the WebSocket server.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Its port; 0: any.", min=0, max=65535)] = 8765,
    token: Annotated[
        str | None, typer.Option(envvar="IGRIP_TOKEN", help="What clients must show.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the counts at the end.")] = False,
) -> None:  # fmt: skip
    """Watch a camera and say what each hand is about to grasp, and with which grip.

    Example: igrip live --camera oak --tell lsl --out session.mcap

    Example, without a camera: igrip live --camera rendered
    """
    commitment = CommitmentConfig(
        assisted=tuple(assisted) if assisted else ALL_HANDS, reliability=reliability,
        needs_confirmation=confirm,
    )  # fmt: skip
    config = Config(commitment=commitment, targets=targets or Config().targets)
    with ExitStack() as stack:
        with errors.status("Reading meshes, models and compiling (longer the first time) …"):
            known = load_objects(*(catalog or ["ycb"]))
            options = read_options(option or [])
            options["models"] = model or [m for m in PAPER_OBJECTS if m in known] or list(known)
            for name in options["models"]:
                known[name]
            warm_up(config, known)
            count = _check(camera, calibration)
            new_hands = None if hands == NOTHING else hand_eye(hands, max_hands, apart, count)
            new_objects = None if objects == NOTHING else object_eye(objects, known, options)
            warm_up_eyes(new_hands, new_objects, known, options["models"])
            source = open_camera(camera, calibration)
        chain = stack.enter_context(Pipeline(source, new_hands, new_objects))
        recorder = stack.enter_context(open_writer(out)) if out is not None else None
        loop = Loop(Estimator(known, config), chain.begin, recorder)
        notes = Notes(source, chain)
        _outputs(loop, chain, tell or [], assisted, (host, port, token))
        viewer = None if headless else _page(page_port)
        if viewer is not None:
            stack.callback(viewer.close)
        try:
            _run(loop, chain, viewer, seconds, notes, quiet=as_json)
        except KeyboardInterrupt:
            errors.print("stopped")
        finally:
            for sink in loop.outputs:
                sink.close()
            notes.tell()
    report = {"stages": chain.report(), **loop.report()}
    if as_json:
        print_json(report)
    else:
        output.print(_words(report), soft_wrap=True)


class Notes:
    """What a camera or a finder has to say, told once each."""

    def __init__(self, camera: Camera, chain: Pipeline) -> None:
        self._camera, self._chain = camera, chain
        self._told: set[str] = set()

    def tell(self) -> None:
        """Print what is new."""
        for note in (getattr(self._camera, "note", None), *self._chain.problems()):
            if note and note not in self._told:
                self._told.add(note)
                errors.print(note, style="yellow", soft_wrap=True)


def _check(camera: str, calibration: Path | None) -> int:
    """Return how many cameras are named; refuse what would mix places or times."""
    names = split_names(camera)
    if len(names) > 1 and calibration is None:
        raise IgripError(
            "several cameras need --calibration: without it each one's world is its own, and what "
            "one sees would be taken for where another looks (igrip calibrate)"
        )
    for name in names:
        speed = dict(parse_qsl(name.partition("?")[2])).get("speed", "1")
        if speed not in ("1", "1.0"):
            raise IgripError(f"{name}: live runs at the pace of life; leave speed={speed} out")
    return len(names)


def _outputs(
    loop: Loop, chain: Pipeline, outs: list[Out], assisted: list[str] | None,
    server: tuple[str, int, str | None],
) -> None:  # fmt: skip
    if Out.WS in outs:
        from igrip.runtime.websocket import WebSocketServer

        host, port, token = server
        socket = WebSocketServer(
            host, port, Access(host, token), loop.word, loop.count,
            lambda: {"stages": chain.report(), **loop.report()}, takes=True,
        )  # fmt: skip
        loop.outputs.append(socket)
        errors.print(f"ws://{f'[{host}]' if ':' in host else host}:{socket.port}", soft_wrap=True)
    if Out.STDOUT in outs:
        loop.outputs.append(StdoutOutput())
    if Out.LSL in outs:
        from igrip.runtime.outputs.lsl import HANDS, LslOutput

        session = loop.numbering.session
        loop.outputs.append(LslOutput("igrip", session, tuple(assisted) if assisted else HANDS))


def _page(port: int) -> Viewer | None:
    try:
        viewer = Viewer(port=port)
    except MissingExtraError as error:
        errors.print(f"{error}; going on without the page", style="yellow")
        return None
    errors.print(f"The scene is live at {viewer.url}")
    return viewer


def _run(
    loop: Loop, chain: Pipeline, viewer: Viewer | None, seconds: float | None, notes: Notes,
    quiet: bool,
) -> None:  # fmt: skip
    screen = Live(console=errors, refresh_per_second=4, transient=True)
    panel = PicturePanel(viewer.server) if viewer is not None else None
    on_screen = errors.is_terminal and not quiet
    if on_screen:
        screen.start()
    try:
        shown = screen if on_screen else None
        loop.run(chain, _looker(loop, chain, viewer, panel, shown, seconds, notes))
    finally:
        if on_screen:
            screen.stop()
        if panel is not None:
            panel.close()


def _looker(
    loop: Loop, chain: Pipeline, viewer: Viewer | None, panel: PicturePanel | None,
    screen: Live | None, seconds: float | None, notes: Notes,
) -> Callable[[list[Intention]], None]:  # fmt: skip
    """Return what is done after each update: nothing of it waits."""
    began = time.monotonic()
    due = began

    def look(intentions: list[Intention]) -> None:
        nonlocal due
        now = time.monotonic()
        if seconds is not None and now - began >= seconds:
            chain.close()
        estimator = loop.estimator
        if viewer is not None and panel is not None:
            viewer.show(take_snapshot(estimator))
            told = list(estimator.latest.values())
            panel.show({
                camera: Seen(found.frame, found.landmarks, estimator.objects, told)
                for camera, found in chain.pictures().items()
            })  # fmt: skip
        if now >= due:
            due = now + SCREEN_EVERY
            notes.tell()
            report = chain.report()
            if screen is not None:
                screen.update(table_of(estimator.t, report, list(estimator.latest.values())))
            if panel is not None:
                panel.tell(markdown_of(report))

    return look


def _words(report: dict[str, Any]) -> str:
    """Sum up what happened, in a few lines."""
    update = report["update"]
    lines = [f"{report['counts'].get('intentions', 0)} intentions"]
    if "age_p50_ms" in update:
        lines.append(
            f"from exposure to intention: {update['age_p50_ms']:.0f} ms (median), "
            f"{update['age_p99_ms']:.0f} ms (99 %)"
        )
    lines += [
        f"{name}: {stage['count']} frames"
        + (f", {stage['took_p50_ms']:.1f} ms each (median)" if stage.get("took_p50_ms") else "")
        + (f", {stage['skipped']} skipped for newer ones" if stage.get("skipped") else "")
        + (f", {stage['failed']} FAILED" if stage.get("failed") else "")
        for name, stage in report["stages"].items()
    ]
    return "\n".join(lines)
