"""The certificate as a page."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

STYLE = """
body { font: 16px system-ui, sans-serif; max-width: 50rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; } td, th { border: 1px solid #ccc; padding: .3rem .6rem; }
td.n { text-align: right; } .good { color: #17692f; } .bad { color: #b00020; }
"""
NOTE = (
    "This page describes one run on one machine with a virtual device. It is no medical or safety "
    "certification: the stop of a real device adds what its firmware and mechanics take."
)


def page(certificate: dict[str, Any]) -> str:
    """Return a certificate as HTML, in one file."""
    latency, limits, machine = (certificate[k] for k in ("latency", "limits", "machine"))
    beyond = certificate["verdict"]
    title = f"igrip certificate: {certificate['device']}"
    judged = "within all limits" if not beyond else "beyond limits"
    sentences = "".join(f"<li>{escape(text)}</li>" for text in beyond)
    numbers = [
        ("median", f"{latency['p50']:.1f} ms", ""),
        ("99 %", f"{latency['p99']:.1f} ms", f"{limits['latency']:g} ms"),
        ("longest", f"{latency['max']:.1f} ms", ""),
        ("jitter (standard deviation)", f"{latency['jitter']:.1f} ms", ""),
        ("missed deadlines", f"{latency['missed']:.2%}", f"{limits['missed']:.2%}"),
        ("observations", str(latency["count"]), ""),
    ]
    stops = [
        (
            one["fault"], one["meaning"],
            ", ".join(f"{t:.0f}" for t in one["times"]) + (
                f"; {one['never']} × not within 10 s" if one["never"] else ""
            ),
            f"{limits['stop']:g}",
        )
        for one in certificate["stops"]
    ]  # fmt: skip
    facts = [
        ("when", certificate["when"]), ("device", certificate["device"]),
        ("hardware", certificate["hardware"]), ("system", machine["system"]),
        ("processor", f"{machine['processor']} × {machine['processors']}"),
        ("load before, after", " / ".join(
            ", ".join(f"{x:.1f}" for x in certificate["load"][k]) for k in ("before", "after")
        )),
        *machine["versions"].items(),
    ]  # fmt: skip
    return f"""<!doctype html>
<html lang="en"><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title><style>{STYLE}</style>
<body><main>
<h1>{escape(title)}</h1>
<p class="{"bad" if beyond else "good"}"><strong>{judged}</strong></p><ul>{sentences}</ul>
<p>{escape(NOTE)}</p>
<h2>From observation to received intention</h2>
{_table(("quantity", "measured", "limit"), numbers)}
<h2>From the fault, or the last good observation, to the stop at the device [ms]</h2>
{_table(("fault", "what happens", "each time", "limit"), stops)}
<h2>Machine</h2>
{_table(("fact", "value"), facts)}
</main></body></html>
"""


def _table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    top = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>\n"
        for row in rows
    )
    return f"<table><tr>{top}</tr>\n{body}</table>"
