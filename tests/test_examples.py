"""The examples and the README run as they stand."""

import re
import subprocess
import sys
from itertools import islice
from pathlib import Path

import igrip
from igrip.io.recordings.jsonl import JsonlWriter
from igrip.lab.simulation.demo import DemoPerson

ROOT = Path(__file__).parents[1]


def run(*arguments: object) -> str:
    done = subprocess.run(
        [sys.executable, *map(str, arguments)], capture_output=True, text=True, timeout=240
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_hello() -> None:
    lines = run(ROOT / "examples" / "01_hello.py").splitlines()
    assert lines[0] == "0.00 s warming_up None 0% None"
    assert re.fullmatch(r"1.00 s reaching mustard 9\d% palmar", lines[-1])


def test_the_readme_shows_the_example() -> None:
    code = (ROOT / "examples" / "01_hello.py").read_text().partition('"""\n\n')[2]
    assert f"```python\n{code}```" in (ROOT / "README.md").read_text()


def test_replay(tmp_path: Path) -> None:
    path = tmp_path / "reach.jsonl"
    with JsonlWriter(path) as file:
        for moment in islice(DemoPerson(igrip.load_objects("ycb")), 90):
            file.write(moment.observation)
    assert "hand" in run(ROOT / "examples" / "02_replay.py", path)


def test_add_a_cue() -> None:
    assert run(ROOT / "examples" / "03_add_a_cue.py").startswith("ahead {")
