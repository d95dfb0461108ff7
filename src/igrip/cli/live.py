"""``igrip live``: a camera, and what each hand in its picture is about to grasp."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import ExitStack, nullcontext
from pathlib import Path
from typing import Annotated, Any
from urllib.parse import parse_qsl

import typer
from rich.live import Live

from igrip.cli import estimator_setup as setup
from igrip.cli import options
from igrip.cli.console import errors, output, print_json, until_interrupted, warn
from igrip.cli.device_option import device_process
from igrip.cli.live_table import COLUMNS, live_table, rows_of
from igrip.cli.outputs import free_port
from igrip.cli.page import open_page
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.io.person_file import PersonFile
from igrip.io.recordings import open_writer
from igrip.objects.catalog import PAPER_OBJECTS, Catalog, load_objects
from igrip.objects.mesh_writer import models_beside, write_models
from igrip.perception.cameras import Camera, open_camera, split_names
from igrip.perception.options import parse_options
from igrip.perception.pipeline.pipeline import Pipeline
from igrip.perception.pipeline.stages import hand_stages, object_stages, warm_up_stages
from igrip.perception.poses import POSES
from igrip.runtime.clock_sync import RunClock
from igrip.runtime.loop import Loop, Output, Sender
from igrip.runtime.options import HANDS, Options
from igrip.runtime.outputs import OUTPUTS
from igrip.runtime.stream_input import StreamInput
from igrip.viewer.camera_panel import CameraPanel
from igrip.viewer.naming_panel import NamingPanel
from igrip.viewer.overlay import CameraView
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import take_snapshot

SCREEN_INTERVAL = 0.5  # s
NOTHING = "none"


def live(
    camera: Annotated[
        str,
        typer.Option(help="oak, realsense, webcam:0, replay:FILE.mcap, rendered; several joined by "
                     "+, as in oak:ID1+oak:ID2."),
    ] = "oak",
    hands: Annotated[
        str, typer.Option(help="Hand detector: auto, mediapipe, depth, tags; none: no hands.")
    ] = "mediapipe",
    poses: Annotated[
        str,
        typer.Option(help="Pose estimator: auto (known things by name, others as object_1 …), "
                     "depth, shapes, tags, cosypose; none: no objects. --objects NAME does the "
                     "same."),
    ] = "auto",
    objects: options.Objects = None,
    model: Annotated[
        list[str] | None,
        typer.Option(help="A model that may be on the table; repeatable. Default: the paper's "
                     "four."),
    ] = None,
    option: Annotated[
        list[str] | None,
        typer.Option(help="NAME=VALUE for the pose estimator, such as tags=tags.toml; repeatable."),
    ] = None,
    hand_option: Annotated[
        list[str] | None,
        typer.Option(help="NAME=VALUE for the hand detector, such as tags=hands.toml; repeatable."),
    ] = None,
    calibration: options.Calibration = None,
    separate_hands: Annotated[
        bool,
        typer.Option("--separate-hands", help="Give the hands of each camera ids of their own."),
    ] = False,
    max_hands: Annotated[int, typer.Option(help="Hands looked for.", min=1, max=4)] = 2,
    out: Annotated[
        list[str] | None,
        typer.Option(help="Where intentions go: ws, stdout, lsl, udp, osc, mqtt or ros2; "
                     "repeatable."),
    ] = None,
    record: Annotated[
        Path | None,
        typer.Option(help="Record what the estimator is given: F.jsonl or F.mcap; igrip replay "
                     "gives the same intentions again."),
    ] = None,
    config: options.ConfigFile = None,
    targets: options.Targets = None,
    assisted: options.Assisted = None,
    reliability: options.Reliability = None,
    confirm: options.Confirm = False,
    person: options.Person = None,
    device: options.Device = None,
    device_config: options.DeviceConfig = None,
    arm: options.Arm = False,
    twin: options.Twin = False,
    seconds: Annotated[
        float | None, typer.Option(help="Default: until Ctrl-C, or the end of a recording.", min=0)
    ] = None,
    headless: Annotated[bool, typer.Option(help="No page in the browser.")] = False,
    page_port: options.PagePort = 8080,
    host: options.Host = "127.0.0.1",
    port: options.Port = 8765,
    token: options.Token = None,
    udp_to: options.UdpTo = Options.udp_to,
    osc_to: options.OscTo = Options.osc_to,
    mqtt: options.Mqtt = Options.mqtt,
    ros_frame: options.RosFrame = Options.ros_frame,
    as_json: options.Json = False,
) -> None:  # fmt: skip
    """Watch a camera and predict what each hand is about to grasp, and with which grip.

    Example: igrip live --camera oak --out lsl --record session.mcap

    Example, without a camera: igrip live --camera rendered
    """
    # every name is looked up before anything slow begins
    settings = setup.estimator_config(targets, assisted, reliability, confirm, config)
    kept = None if person is None else PersonFile(person, settings.commitment.adaptation)
    count = _check(camera, calibration)
    poses, objects = _poses_and_objects(poses, objects or [])
    new_hands = None if hands == NOTHING else hand_stages(
        hands, max_hands, separate_hands, count, parse_options(hand_option or [])
    )  # fmt: skip
    if poses != NOTHING:
        POSES.check(poses)
    pose_options = parse_options(option or [])
    output_options = Options(
        host, port, token, hands=tuple(assisted or HANDS), udp_to=udp_to, osc_to=osc_to, mqtt=mqtt,
        ros_frame=ros_frame,
    )  # fmt: skip
    outputs = {name: _output(name)(output_options) for name in out or []}
    process = device_process(device, device_config, arm, twin, headless)
    if process is not None:
        outputs["device"] = process
    if not headless:
        page_port = free_port(page_port, "--page-port")
    if "ws" in outputs:
        free_port(port, host=host)
    with ExitStack() as stack:
        recorder = None if record is None else stack.enter_context(open_writer(record))
        with errors.status("Reading meshes, models and compiling (longer the first time) …"):
            known = load_objects(*(objects or ["ycb"]))
            models = model or [m for m in PAPER_OBJECTS if m in known] or list(known)
            pose_options["models"] = models
            for name in models:
                known[name]
            setup.warm_up(settings, known)
            new_objects = None if poses == NOTHING else object_stages(poses, known, pose_options)
            warm_up_stages(new_hands, new_objects, known, models)
            source = open_camera(camera, calibration)
        pipeline = stack.enter_context(Pipeline(source, new_hands, new_objects))
        loop = Loop(
            Estimator(known, settings, None if kept is None else kept.person),
            RunClock(pipeline.begin), {"camera": StreamInput(pipeline)}, outputs,
            record=None if recorder is None else recorder.write,
            announce=lambda address: errors.print(address, soft_wrap=True),
            source_report=lambda: {"stages": pipeline.report()},
        )  # fmt: skip
        problems = ProblemPrinter(source, pipeline)
        person_at_page = Sender(lambda error: warn(str(error)), "the page")
        viewer = None if headless else open_page(
            page_port, targets=settings.targets,
            on_command=lambda command: loop.submit(command, person_at_page),
        )  # fmt: skip
        if viewer is not None:
            stack.callback(viewer.close)
        stack.callback(problems.print_new)
        if kept is not None:
            stack.callback(kept.keep)
        if record is not None:
            stack.callback(lambda: write_models(models_beside(record), known.put_models))
        with until_interrupted():
            _run(loop, pipeline, known, viewer, seconds, problems, kept, quiet=as_json)
    report = loop.status()
    if as_json:
        print_json(report)
    else:
        output.print(_summary(report), soft_wrap=True)


class ProblemPrinter:
    """Prints what a camera or a detector reports to be wrong, once each."""

    def __init__(self, camera: Camera, pipeline: Pipeline) -> None:
        self._camera, self._pipeline = camera, pipeline
        self._printed: set[str] = set()

    def print_new(self) -> None:
        """Print the problems that were not printed before."""
        for problem in (getattr(self._camera, "note", None), *self._pipeline.problems()):
            if problem and problem not in self._printed:
                self._printed.add(problem)
                warn(problem)


def _output(name: str) -> Callable[[Options], Output]:
    """Return an output's member; refuse the name of a file."""
    if Path(name).suffix and name not in OUTPUTS.names():
        raise IgripError(f"--out {name}: intentions go to an output; --record {name} records")
    return OUTPUTS.get(name)


def _poses_and_objects(poses: str, objects: list[str]) -> tuple[str, list[str]]:
    """Return the pose estimator and where models come from; ``--objects`` may name the former."""
    for name in (*POSES.names(), NOTHING):
        if name in objects:
            warn(f"--objects {name}: the pose estimator is --poses {name} now")
            return name, [source for source in objects if source != name]
    return poses, objects


def _check(camera: str, calibration: Path | None) -> int:
    """Return the number of cameras; refuse what would mix up places or times."""
    names = split_names(camera)
    if len(names) > 1 and calibration is None:
        raise IgripError(
            "several cameras need --calibration (igrip calibrate): without it each one has a world "
            "frame of its own, and what they measure cannot be merged"
        )
    for name in names:
        speed = dict(parse_qsl(name.partition("?")[2])).get("speed", "1")
        if speed not in ("1", "1.0"):
            raise IgripError(f"{name}: igrip live runs in real time; leave out speed={speed}")
    return len(names)


def _run(
    loop: Loop, pipeline: Pipeline, known: Catalog, viewer: Viewer | None, seconds: float | None,
    problems: ProblemPrinter, kept: PersonFile | None, quiet: bool,
) -> None:  # fmt: skip
    """Run the loop; show its results after each update, without blocking it."""
    panel = None if viewer is None else CameraPanel(viewer)
    naming = None if viewer is None else NamingPanel(viewer, pipeline.give_name)
    screen = Live(console=errors, refresh_per_second=4, transient=True)
    begin = due = time.monotonic()

    def show(intentions: list[Intention]) -> None:
        nonlocal due
        now = time.monotonic()
        if seconds is not None and now - begin >= seconds:
            pipeline.close()
        estimator = loop.estimator
        newest = list(estimator.latest.values())
        if viewer is not None and panel is not None:
            viewer.show(take_snapshot(estimator))
            if naming is not None:
                unknown = known.put_models
                naming.set_things([o.id for o in estimator.objects if o.model.name in unknown])
            panel.show({
                camera: CameraView(found.frame, found.landmarks, estimator.objects, newest)
                for camera, found in pipeline.latest_hands().items()
            })  # fmt: skip
        if now >= due:
            due = now + SCREEN_INTERVAL
            problems.print_new()
            if kept is not None:
                kept.keep()
            stages = pipeline.report()
            screen.update(live_table(estimator.t, stages, newest))
            if panel is not None:
                panel.set_table(COLUMNS, rows_of(stages))

    try:
        with screen if errors.is_terminal and not quiet else nullcontext(), loop:
            loop.run(show)
    finally:
        if panel is not None:
            panel.close()


def _summary(report: dict[str, Any]) -> str:
    """Return the counts and latencies of a run, in a few lines."""
    update = report["update"]
    lines = [f"{report['intentions']} intentions"]
    if "age_p50_ms" in update:
        lines.append(
            f"from exposure to intention: {update['age_p50_ms']:.0f} ms (median), "
            f"{update['age_p99_ms']:.0f} ms (99 %)"
        )
    for name, stage in report["stages"].items():
        line = f"{name}: {stage['count']} frames"
        if stage.get("duration_p50_ms"):
            line += f", {stage['duration_p50_ms']:.1f} ms each (median)"
        if stage.get("skipped"):
            line += f", {stage['skipped']} skipped for newer frames"
        if stage.get("failed"):
            line += f", {stage['failed']} FAILED"
        lines.append(line)
    return "\n".join(lines)
