"""The options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from igrip.cli.outputs import file_option
from igrip.targets import TARGETS

TARGETS_HELP = f"Targets estimator: {', '.join(TARGETS.names())}."

Json = Annotated[bool, typer.Option("--json", help="Print JSON for a program.")]
Targets = Annotated[str | None, typer.Option(help=f"{TARGETS_HELP} Default: the library's, bayes.")]
Objects = Annotated[
    list[str] | None,
    typer.Option(help="Where models come from: ycb, a folder, box:…, cylinder:…; repeatable. "
                 "Default: the dataset's own, or ycb."),
]  # fmt: skip
Seed = Annotated[int, typer.Option(help="Seed of all that is random.", min=0)]
Jobs = Annotated[int, typer.Option(help="Processes; 0: one per processor.", min=0)]
Scheduler = Annotated[
    str | None,
    typer.Option(help="Address of a Dask scheduler whose workers do it, tcp://HOST:8786."),
]
Limit = Annotated[
    int, typer.Option(help="At most this many, evenly spread over the table; 0: all.", min=0)
]
PagePort = Annotated[
    int, typer.Option(help="Port of the page; 0: any that is free.", min=0, max=65535)
]
Calibration = Annotated[
    Path | None, typer.Option(help="Where the cameras stand: a file of igrip calibrate.")
]

Assisted = Annotated[
    list[str] | None,
    typer.Option(help="A hand that a device assists; repeatable. No other gets a commitment. "
                 "Default: every hand."),
]  # fmt: skip
ConfigFile = Annotated[
    Path | None,
    typer.Option("--config", help="Configuration: a TOML file with the keys of "
                 "docs/configuration.md, such as igrip tune writes. "
                 "Other options take precedence."),
]  # fmt: skip
Reliability = Annotated[
    float | None,
    typer.Option(help="0: commit early, sometimes wrongly; 1: late, or not at all. Default: the "
                 "configuration's, or the library's.", min=0.0, max=1.0),
]  # fmt: skip
Person = Annotated[
    Path | None,
    typer.Option(help="File of what is learned about this person's commitments; created if "
                 "missing. Delete it to start again.", callback=file_option()),
]  # fmt: skip
Confirm = Annotated[
    bool, typer.Option("--confirm", help="Commit only to reaches that are confirmed from outside.")
]
Host = Annotated[str, typer.Option(help="Address of the WebSocket server.")]
PageHost = Annotated[
    str,
    typer.Option(help="Address of the pages; 0.0.0.0 lets other computers in, with a --token."),
]
Port = Annotated[int, typer.Option(help="Its port; 0: any that is free.", min=0, max=65535)]
Token = Annotated[
    str | None,
    typer.Option(envvar="IGRIP_TOKEN", help="Required of clients; needed where others can reach "
                 "the address."),
]  # fmt: skip

UdpTo = Annotated[str, typer.Option(help="HOST:PORT that --out udp sends datagrams of JSON to.")]
OscTo = Annotated[str, typer.Option(help="HOST:PORT that --out osc sends bundles to.")]
Mqtt = Annotated[
    str,
    typer.Option(envvar="IGRIP_MQTT", help="Broker and prefix of --out mqtt: "
                 "mqtt[s]://[USER:PASSWORD@]HOST[:PORT][/PREFIX]."),
]  # fmt: skip
RosFrame = Annotated[str, typer.Option(help="Frame of what --out ros2 sends.")]

Device = Annotated[
    str | None,
    typer.Option(help="A device that acts on leases, in a process of its own: igrip drive, "
                 "igrip list devices."),
]  # fmt: skip
DeviceConfig = Annotated[
    Path | None, typer.Option(help="Configuration of the device: docs/devices.md.")
]
Arm = Annotated[
    bool, typer.Option("--arm", help="Let the device act. Without this, it says what it would do.")
]
Twin = Annotated[bool, typer.Option("--twin", help="A virtual device, whatever the file names.")]

Up = Annotated[
    str | None, typer.Option(help="The source's axis that points up: z (default), y, -z, …")
]
Axes = Annotated[
    str | None,
    typer.Option(help="x, y and z of igrip in terms of the source's axes, such as x,-z,y; in "
                 "place of --up."),
]  # fmt: skip
Handedness = Annotated[
    str | None, typer.Option(help="Of the source's axes: right (default) or left.")
]
Quaternions = Annotated[str, typer.Option(help="Order of their components: xyzw or wxyz.")]
LengthUnit = Annotated[str, typer.Option(help="Of the source: m, dm, cm, mm or in.")]
TimeUnit = Annotated[str, typer.Option(help="Of the source: s, ms, us or ns.")]
