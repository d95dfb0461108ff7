"""The client's rule for leases, the same in three languages, and against the real service."""

from __future__ import annotations

import functools
import importlib.util
import json
import shutil
import subprocess
import threading
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

import igrip
from browser import needs_chromium, open_page
from igrip.runtime.clock_sync import ArrivalClock
from igrip.runtime.inputs import INPUTS
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS
from runtime_fakes import Clock, Collector, reach

CLIENTS = Path(__file__).parents[2] / "docs" / "clients"
LEASE = {"target": "cup", "grip": "palmar", "since": 0.0, "valid_until": 1.0}


def message(seq, valid_for=None, session="a", sent=None):
    given = None if valid_for is None else LEASE
    return {
        "session": session, "seq": seq, "commitment": given, "valid_for": valid_for, "sent": sent
    }  # fmt: skip


# when [s], what comes then, sent when on the service's clock (100 s ahead), and whether a device
# may act at once, and 0.05 s and 0.2 s later
STORY = [
    (0.00, message(1, sent=99.99), (False, False, False)),
    (1.00, message(2, 0.12, sent=100.99), (True, True, False)),
    (2.00, message(3, 0.03, sent=101.99), (True, False, False)),
    (3.00, message(4, 60.0, sent=102.99), (True, True, False)),  # longer than any lease may hold
    (3.10, message(5, sent=103.09), (False, False, False)),  # taken back
    (3.11, message(4, 0.15, sent=102.99), (False, False, False)),  # comes late
    (3.12, message(5, 0.15, sent=103.11), (False, False, False)),  # comes twice
    (4.00, message(6, 0.15, sent=103.89), (True, False, False)),  # was under way 0.1 s longer
    (6.00, message(7, 0.15, sent=103.99), (False, False, False)),  # waited in a buffer for 2 s
    (7.00, message(8, 0.12, sent=106.99), (True, True, False)),
    (8.00, message(1, 0.12, "b", sent=5.0), (True, True, False)),  # the service was started anew
    (9.00, message(2, None, "b", sent=6.0), (False, False, False)),
]
WAITS = (0.0, 0.05, 0.2)


def test_python():
    spec = importlib.util.spec_from_file_location("lease", CLIENTS / "lease.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    now = [0.0]
    lease = module.Lease(lambda: now[0])
    assert not lease.permits()
    lease.update({"error": "hand: is not known", "field": "hand", "count": 1})
    for t, told, expected in STORY:
        now[0] = t
        lease.update(told)
        found = []
        for wait in WAITS:
            now[0] = t + wait
            found.append(lease.permits())
        assert tuple(found) == expected


def test_c(tmp_path):
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler (make system)")
    steps = "\n".join(
        f'lease_update(&l, "{m["session"]}", {m["seq"]}, {m["sent"]}, '
        f"{m['valid_for'] or 0.0}, {t});"
        f'printf("%d%d%d\\n", {", ".join(f"lease_permits(&l, {t} + {w})" for w in WAITS)});'
        for t, m, _ in STORY
    )
    source = tmp_path / "story.c"
    source.write_text(
        f'#include <stdio.h>\n#include "{CLIENTS / "lease.h"}"\n'
        f"int main(void) {{ lease l = {{0}};\n{steps}\nreturn 0; }}\n"
    )
    subprocess.run(
        [compiler, "-std=c99", "-Wall", "-Wextra", "-Werror", source, "-o", tmp_path / "story"],
        check=True,
    )
    done = subprocess.run([tmp_path / "story"], capture_output=True, text=True, check=True)
    expected = ["".join(str(int(may)) for may in row) for *_, row in STORY]
    assert done.stdout.split() == expected


@pytest.mark.browser
@needs_chromium
def test_javascript():
    rule = (CLIENTS / "lease.js").read_text()
    with open_page("about:blank") as page:
        found = page.evaluate(
            f"""([story, waits]) => {{
                {rule}
                let now = 0;
                const lease = new Lease(() => now);
                return story.map(([t, told]) => {{
                    now = t;
                    lease.update(told);
                    return waits.map(wait => {{ now = t + wait; return lease.permits(); }});
                }});
            }}""",
            [[[t, told] for t, told, _ in STORY], WAITS],
        )
    assert [tuple(row) for row in found] == [expected for *_, expected in STORY]


@pytest.fixture
def own_page(tmp_path):
    """Return the address of an empty page that this machine serves."""
    (tmp_path / "index.html").write_text("<title>igrip</title>")
    handler = functools.partial(SilentHandler, directory=tmp_path)
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()
        thread.join()


class SilentHandler(SimpleHTTPRequestHandler):
    """Serves files and prints nothing."""

    def log_message(self, *_):
        """Say nothing."""


@pytest.mark.browser
@needs_chromium
def test_a_page_follows_a_real_lease(shapes, own_page):
    """A browser's own WebSocket, the rule, a reach, and silence at its end."""
    config = igrip.Config(targets="paper", commitment={"reliability": 0.0})
    story = [json.loads(message.to_json()) for message in reach(40)]
    options, output = Options(port=0), Collector()
    clock = Clock()

    def pass_time(envelope):
        clock.t += 1.0 / 30.0

    output.send = pass_time  # before the page gets the intention, and sends its next message
    loop = Loop(
        igrip.Estimator(shapes, config), ArrivalClock(clock=clock),
        {"ws": INPUTS.get("ws")(options)}, {"clock": output, "ws": OUTPUTS.get("ws")(options)},
    )  # fmt: skip
    working = threading.Thread(target=loop.run, daemon=True)
    with loop:
        working.start()
        with open_page("about:blank") as page:
            page.goto(own_page)  # a page of this machine; others may not connect
            during, after = page.evaluate(
                f"""async ([address, story]) => {{
                    {(CLIENTS / "lease.js").read_text()}
                    const open = path => new Promise((done, failed) => {{
                        const socket = new WebSocket(address + path);
                        socket.onopen = () => done(socket);
                        socket.onerror = failed;
                    }});
                    const lease = new Lease();
                    const out = await open("/intentions"), source = await open("/observations");
                    const answer = () => new Promise(done => {{
                        out.onmessage = event => {{
                            lease.update(JSON.parse(event.data));
                            done(lease.permits());
                        }};
                    }});
                    let during = 0;
                    for (const message of story) {{
                        const permitted = answer();
                        source.send(JSON.stringify(message));
                        during += await permitted;
                    }}
                    await new Promise(done => setTimeout(done, 300));
                    return [during, lease.permits()];
                }}""",
                [f"ws://127.0.0.1:{options.shared['websocket'].port}", story],
            )
        loop.finish()
        working.join(60.0)
    assert during > 5
    assert after is False
