"""``igrip certify``: latencies and times to stop, on this machine, against limits."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli.console import errors, output, print_json, table_of
from igrip.cli.outputs import folder_option
from igrip.devices import DEVICES, device_name
from igrip.devices.base.settings import read_settings
from igrip.lab.certificate.measure import Limits, measure
from igrip.lab.certificate.page import page
from igrip.objects.catalog import load_objects

BEYOND = 3  # exit code


def certify(
    device: Annotated[str, typer.Option(help="The device, as of igrip drive.")],
    config: Annotated[Path, typer.Option(help="Its configuration; its virtual twin is used.")],
    out: Annotated[
        Path, typer.Option(help="Folder for certificate.html and .json.", callback=folder_option())
    ] = Path("certificate"),
    seconds: Annotated[float, typer.Option(help="Of the latency measurement.", min=5)] = 30.0,
    repeats: Annotated[int, typer.Option(help="Of each fault.", min=1)] = 3,
    limit_latency: Annotated[
        float, typer.Option(help="ms from observation to intention, 99 %.", min=1)
    ] = 100.0,
    limit_stop: Annotated[
        float, typer.Option(help="ms from the fault to the stop at the device.", min=1)
    ] = 200.0,
    limit_missed: Annotated[
        float, typer.Option(help="Share of intentions later than the limit.", min=0, max=1)
    ] = 0.01,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON for a program.")] = False,
) -> None:
    """Measure latencies and times to stop on this machine, and judge them by your limits.

    A simulated person is sent to igrip stream, and igrip drive acts on a virtual device; then the
    hand is lost, processes are killed, the port is pulled. Exit code 3: beyond a limit.

    Example: igrip certify --device serial --config serial.toml --limit-stop 200
    """
    name = device_name(device)
    read_settings(DEVICES.get(name).Settings, config)
    limits = Limits(limit_latency, limit_stop, limit_missed)
    catalog = load_objects("ycb")
    with (
        tempfile.TemporaryDirectory() as folder,
        errors.status("Starting …") as status,
    ):
        found = measure(
            name, config, catalog, Path(folder), limits, seconds, repeats,
            lambda text: status.update(f"Measuring: {text} …"),
        )  # fmt: skip
    out.mkdir(parents=True, exist_ok=True)
    text = json.dumps(found, indent=2, allow_nan=False)
    (out / "certificate.json").write_text(text + "\n", encoding="utf-8")
    (out / "certificate.html").write_text(page(found), encoding="utf-8")
    if as_json:
        print_json(found)
    else:
        latency = found["latency"]
        rows = [("latency, 99 %", f"{latency['p99']:.0f}", f"{limits.latency:g}")]
        for stop in found["stops"]:
            longest = f"{max(stop['times']):.0f}" if stop["times"] else "-"
            rows.append((stop["fault"], longest, f"{limits.stop:g}"))
        output.print(table_of(("", "longest [ms]", "limit [ms]"), rows))
        for sentence in found["verdict"] or ["within all limits"]:
            output.print(sentence, soft_wrap=True)
        output.print(f"{out / 'certificate.html'}", soft_wrap=True)
    if found["verdict"]:
        raise typer.Exit(BEYOND)
