"""CONTRIBUTING.md is true: its cue works, its paths exist, its families are all of them."""

import os
import pkgutil
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from igrip.registry import Registry

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "igrip"
TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
SNIPPET = re.search(r"```python\n(.*?)```", TEXT, re.DOTALL)[1]
USE = """
import sys
import igrip.cues
igrip.cues.__path__.append(sys.argv[1])
import igrip
catalog = igrip.load_objects("box:0.05x0.05x0.2")
estimator = igrip.Estimator(catalog)
box = {"model": "box:0.05x0.05x0.2", "orientation": [0, 0, 0, 1]}
places = {"ahead": [0.5, 0, 0], "aside": [0, 0.5, 0]}
objects = {name: {**box, "position": place} for name, place in places.items()}
for frame in range(10):
    hands = {"right": {"position": [0.01 * frame, 0, 0]}}
    (intention,) = estimator.update(igrip.Observation(t=frame / 30, hands=hands, objects=objects))
print(intention.scores["ahead"]["heading"], intention.scores["aside"]["heading"])
"""


def families() -> dict[str, Registry]:
    """Return every registry of igrip by ``package.NAME``."""
    found = {}
    for path in PACKAGE.rglob("__init__.py"):
        names = re.findall(r"^(\w+): Registry\[", path.read_text(encoding="utf-8"), re.MULTILINE)
        module = ".".join(("igrip", *path.parent.relative_to(PACKAGE).parts))
        for name in names:
            found[f"{module}.{name}"] = getattr(pkgutil.resolve_name(module), name)
    return found


def test_the_cue_works_when_its_file_is_added(tmp_path: Path) -> None:
    (tmp_path / "heading.py").write_text(SNIPPET, encoding="utf-8")
    command = [sys.executable, "-c", USE, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr
    ahead, aside = map(float, done.stdout.split())
    assert ahead > 0.99
    assert ahead > aside


def test_the_cue_scores_zero_at_the_centre_of_an_object(monkeypatch: pytest.MonkeyPatch) -> None:
    namespace: dict[str, Any] = {}
    monkeypatch.setattr("igrip.cues.cue", lambda name, order: lambda function: function)
    exec(compile(SNIPPET, "heading.py", "exec"), namespace)
    motion = SimpleNamespace(position=np.zeros(3), velocity=np.array([0.5, 0, 0]), speed=0.5)
    centres = np.array([[0.0, 0, 0], [0.3, 0, 0], [-0.3, 0, 0], [0, 0.3, 0]])
    geometry = SimpleNamespace(objects=[SimpleNamespace(centre=centre) for centre in centres])
    scores = namespace["heading"](motion, geometry, None)
    np.testing.assert_allclose(scores, [0, 1, -1, 0], atol=1e-12)


def test_the_cue_passes_the_type_check(tmp_path: Path) -> None:
    file = tmp_path / "heading.py"
    file.write_text(SNIPPET, encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--follow-imports=silent", str(file)]
    environment = {**os.environ, "MYPYPATH": str(ROOT / "src")}
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=600, check=False, cwd=ROOT, env=environment
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_table_of_families_is_complete() -> None:
    rows = re.findall(r"^\| [^|]+ \| `(igrip[\w.]+)` \| `(igrip[\w.]+)` \|", TEXT, re.MULTILINE)
    assert dict(rows) == {name: registry.group for name, registry in families().items()}


@pytest.mark.parametrize("guide", ["CONTRIBUTING.md", "README.md"])
def test_paths_exist(guide: str) -> None:
    text = (ROOT / guide).read_text(encoding="utf-8")
    for link in re.findall(r"\]\((?!https?:)([^)#]+)", text):
        assert (ROOT / link).exists(), link
    for name in re.findall(r"`((?:src|docs|tests|examples|training|benchmarks)/[\w./]*)", text):
        if name not in ("src/igrip/cues/heading.py", "tests/cues/test_heading.py", "tests/"):
            assert (ROOT / name).exists(), name


def test_every_package_has_its_row() -> None:
    table = TEXT[TEXT.index("| package |") : TEXT.index("Outside `src/igrip`")]
    named = set(re.findall(r"`(\w+)/?`", table))
    parts = {path.stem for path in PACKAGE.iterdir() if path.suffix == ".py" or path.is_dir()}
    assert parts - named == {"__init__", "__main__", "__pycache__", "version", "py"} & parts
    for file in re.findall(r"`((?:lab|cli|perception|runtime)/[a-z_/]+\.py)`", TEXT):
        assert (PACKAGE / file).exists(), file
