"""``igrip stream`` from the terminal."""

from __future__ import annotations

import itertools
import json
import re
import signal
import socket
import subprocess
import sys
import urllib.request

import pytest

import igrip
from igrip.lab.simulation.demo import DemoPerson


def stream(*options, **more):
    return subprocess.run(
        [sys.executable, "-m", "igrip", "stream", *options], capture_output=True, text=True,
        timeout=120, check=False, **more,
    )  # fmt: skip


def test_help_has_an_example():
    told = stream("--help").stdout
    assert "Example: igrip stream --in stdin" in told
    assert "--assisted" in told


def test_others_need_a_token():
    done = stream("--host", "0.0.0.0")
    assert done.returncode == 2
    assert "IGRIP_TOKEN" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_port_that_is_taken_is_named():
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        done = stream("--port", str(port))
    assert done.returncode == 2
    assert f"port {port} is in use" in done.stderr
    assert "Traceback" not in done.stderr


def test_an_empty_input_ends_at_once_and_is_an_error():
    done = stream("--in", "stdin", "--out", "stdout", stdin=subprocess.DEVNULL)
    assert (done.returncode, done.stdout) == (2, "")
    assert "0 intentions" in done.stderr
    assert "standard input is empty" in done.stderr


def test_a_reader_that_goes_away_is_no_crash(tmp_path):
    lines = "\n".join(
        f'{{"t": {k / 30}, "hands": {{"right": {{"position": [{0.001 * k}, 0, 0]}}}}}}'
        for k in range(5000)
    )
    (tmp_path / "in.jsonl").write_text(lines)
    command = f'"{sys.executable}" -m igrip stream --in stdin --out stdout < in.jsonl | head -n 2'
    done = subprocess.run(
        command, shell=True, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False
    )
    assert len(done.stdout.splitlines()) == 2
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("--reliability=2", "--reliability"),
        (
            "--in=carrier-pigeon",
            "no input is named 'carrier-pigeon'; there are: lsl, osc, ros2, stdin, ws",
        ),
        (
            "--out=carrier-pigeon",
            "no output is named 'carrier-pigeon'; there are: lsl, mqtt, osc, ros2, stdout, udp, ws",
        ),
        ("--targets=nobody", "nobody"),
        ("--senders-clock", "--in stdin alone"),
    ],
)
def test_unknown_options_are_refused_with_the_choices(option, message):
    done = stream(option)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert message in done.stderr


def test_lines_that_nobody_reads_are_counted_at_the_end():
    process = subprocess.Popen(
        [sys.executable, "-m", "igrip", "stream", "--in", "stdin", "--in", "ws", "--port", "0",
         "--out", "stdout"],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    with process:
        address = next(line for line in process.stderr if line.startswith(b"ws://")).decode()
        sent = 0

        def intentions():
            with urllib.request.urlopen(f"http{address.strip()[2:]}/status", timeout=60) as answer:
                return json.load(answer)["intentions"]

        while intentions() < 1500:  # many times what the pipe holds
            for _ in range(100):
                hands = {"right": {"position": [0.001 * sent, 0.0, 0.0]}}
                process.stdin.write(json.dumps({"t": sent / 30, "hands": hands}).encode() + b"\n")
                sent += 1
            process.stdin.flush()
        process.send_signal(signal.SIGINT)
        report = process.stderr.read().decode()  # the pipe of standard output stays full
        lines = process.stdout.read().count(b"\n")
    assert process.returncode == 0
    assert "Traceback" not in report
    total, written, lost = (
        int(re.search(pattern, report)[1])
        for pattern in (r"(\d+) intentions", r"stdout: (\d+) sent", r"sent, (\d+) lost")
    )
    assert written == lines
    assert written + lost == total
    assert lost > 0


def test_what_is_learned_of_a_person_is_kept(tmp_path):
    """A day of the demo's person, piped; the second day begins where the first one ended."""
    catalog = igrip.load_objects("ycb")
    messages = [
        moment.observation.to_json()
        for moment in itertools.islice(DemoPerson(catalog, seed=0), 1800)
    ]
    person = tmp_path / "anna.json"
    days = []
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-m", "igrip", "stream", "--in", "stdin", "--out", "stdout",
             "--person", str(person)],
            input=b"\n".join(messages), capture_output=True, timeout=300, check=True,
        )  # fmt: skip
        assert done.stdout
        days.append(json.loads(person.read_text()))
    first, second = days
    assert first["reaches"] > 5
    assert second["reaches"] == 2 * first["reaches"]
    assert second["margin"] <= first["margin"] < 0.0  # a person who is understood
    assert first["wrong"] == 0


def test_a_file_that_is_not_of_a_person_is_refused(tmp_path):
    (tmp_path / "other.json").write_text("{}")
    done = stream("--in", "stdin", "--person", str(tmp_path / "other.json"))
    assert done.returncode == 2
    assert "not the file of a person" in done.stderr
