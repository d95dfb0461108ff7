"""The examples and the README run as they stand."""

import os
import re
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def run(*arguments: object) -> str:
    done = subprocess.run(
        [sys.executable, *map(str, arguments)], capture_output=True, text=True, timeout=280,
        env={**os.environ, "MPLBACKEND": "agg"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_hello() -> None:
    lines = run(ROOT / "examples" / "01_hello.py").splitlines()
    assert lines[0] == "0.00 s warming_up None 0% None"
    assert re.fullmatch(r"1.00 s reaching mustard 9\d% palmar", lines[-1])


def test_a_cue_of_ones_own_decides_the_target() -> None:
    lines = run(ROOT / "examples" / "03_add_a_cue.py").splitlines()
    at_30, at_60 = (line.split()[-1] for line in lines[1:3])  # degrees of the turn
    assert (at_30, at_60) == ("ahead", "aside")


def test_the_readme_shows_the_example() -> None:
    code = (ROOT / "examples" / "01_hello.py").read_text().partition('"""\n\n')[2]
    assert f"```python\n{code}```" in (ROOT / "README.md").read_text()


def test_there_are_at_least_twelve_examples_with_consecutive_numbers() -> None:
    assert len(EXAMPLES) >= 12
    assert [int(path.name[:2]) for path in EXAMPLES] == list(range(1, len(EXAMPLES) + 1))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_draws_its_picture(example: Path, tmp_path: Path) -> None:
    picture = tmp_path / "picture.png"
    assert run(example, picture).strip()
    pixels = cv2.imread(str(picture)).reshape(-1, 3)
    colours, counts = np.unique(pixels, axis=0, return_counts=True)
    assert len(colours) > 50  # curves and text, smoothed
    assert 1 - counts.max() / len(pixels) > 0.005  # something else than the background


def test_the_gallery_shows_every_example_with_its_picture_and_its_output() -> None:
    page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    for example in EXAMPLES:
        assert f"](pictures/gallery/{example.stem}.png)" in page
        assert f'"examples/{example.name}"' in page
        assert (ROOT / "docs" / "pictures" / "gallery" / f"{example.stem}.png").is_file()
        assert (ROOT / "docs" / "output" / f"{example.stem}.txt").read_text().strip()
