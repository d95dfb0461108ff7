"""``igrip stream`` from the terminal."""

from __future__ import annotations

import socket
import subprocess
import sys

import pytest


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
    assert f"127.0.0.1:{port}" in done.stderr
    assert "Traceback" not in done.stderr


def test_an_empty_input_ends_at_once():
    done = stream("--in", "stdin", "--out", "stdout", stdin=subprocess.DEVNULL)
    assert (done.returncode, done.stdout) == (0, "")
    assert "0 intentions" in done.stderr


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


@pytest.mark.parametrize("option", ["--reliability=2", "--in=carrier-pigeon", "--targets=nobody"])
def test_what_is_not_known_is_refused_in_words(option):
    done = stream(option)
    assert done.returncode != 0
    assert "Traceback" not in done.stderr
    assert done.stderr
