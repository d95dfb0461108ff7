"""The wheel and the source distribution: built, checked, installed."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import venv
import zipfile
from dataclasses import dataclass
from email import message_from_string
from email.message import Message
from pathlib import Path
from typing import Any

import pytest

from igrip import __version__

ROOT = Path(__file__).parents[2]
GENERATED = re.compile(r"PKG-INFO|setup\.cfg|src/igrip\.egg-info/.*")
DEMO = ("demo", "--headless", "--duration", "3", "--speed", "0")


def run(*command: object, cwd: Path | None = None, env: dict[str, str] | None = None) -> str:
    done = subprocess.run(
        [*map(str, command)], cwd=cwd, env=env, capture_output=True, text=True, timeout=900
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def checkout() -> set[str]:
    """Return the files that belong to the checkout."""
    if (ROOT / ".git").exists():
        listed = run(
            "git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", cwd=ROOT
        )
        return {name for name in listed.split("\0") if name and (ROOT / name).is_file()}
    listed = (ROOT / "src" / "igrip.egg-info" / "SOURCES.txt").read_text().splitlines()
    return {name for name in listed if not GENERATED.fullmatch(name)}


@dataclass
class Distributions:
    wheel: Path
    sdist: Path

    def wheel_files(self) -> set[str]:
        with zipfile.ZipFile(self.wheel) as archive:
            return set(archive.namelist())

    def sdist_files(self) -> set[str]:
        with tarfile.open(self.sdist) as archive:
            names = {member.name for member in archive.getmembers() if member.isfile()}
        return {name.partition("/")[2] for name in names}

    def metadata(self) -> Message:
        with zipfile.ZipFile(self.wheel) as archive:
            name = f"igrip-{__version__}.dist-info/METADATA"
            return message_from_string(archive.read(name).decode())


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Distributions:
    """Build both from a copy of the checkout, the wheel from the source distribution."""
    copy, out = tmp_path_factory.mktemp("checkout"), tmp_path_factory.mktemp("dist")
    for name in checkout():
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, copy / name)
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", out, copy)
    (wheel,), (sdist,) = out.glob("*.whl"), out.glob("*.tar.gz")
    return Distributions(wheel, sdist)


def test_they_pass_the_check_of_the_index(built: Distributions) -> None:
    assert run(sys.executable, "-m", "twine", "check", "--strict", built.wheel, built.sdist)


def test_the_source_distribution_is_the_whole_checkout(built: Distributions) -> None:
    files = {name for name in built.sdist_files() if not GENERATED.fullmatch(name)}
    assert files == checkout()


def test_the_wheel_is_the_package_and_nothing_else(built: Distributions) -> None:
    files = {name for name in built.wheel_files() if ".dist-info/" not in name}
    package = {name.removeprefix("src/") for name in checkout() if name.startswith("src/igrip/")}
    assert files == package
    assert {"igrip/py.typed", "igrip/lab/report/report.html"} <= files
    assert f"igrip-{__version__}.dist-info/licenses/LICENSE" in built.wheel_files()


def test_the_metadata_is_true(built: Distributions) -> None:
    metadata = built.metadata()
    assert metadata["Version"] == __version__
    assert metadata["License-Expression"] == "MIT"
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert set(metadata.get_all("Provides-Extra") or ()) == set(project["optional-dependencies"])
    assert metadata["Description-Content-Type"] == "text/markdown"


def outside(folder: Path) -> dict[str, Any]:
    """Return the options of :func:`run` to run in a folder, away from the sources."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return {"cwd": folder, "env": {**environment, "IGRIP_CACHE_DIR": str(folder / "cache")}}


def install(wheel: Path, folder: Path, *options: str) -> Path:
    """Install the wheel into a fresh environment; return its folder of commands."""
    venv.create(folder, with_pip=False)
    pip = (sys.executable, "-m", "pip", "--python", folder / "bin" / "python")
    run(*pip, "install", "--quiet", *options, wheel, **outside(folder.parent))
    return folder / "bin"


def test_the_installed_wheel_runs(built: Distributions, tmp_path: Path) -> None:
    """The dependencies are borrowed from this environment, igrip is not."""
    commands = install(built.wheel, tmp_path / "venv", "--no-deps", "--no-index")
    (site,) = (tmp_path / "venv" / "lib").glob("python3.*/site-packages")
    borrowed = next(path for path in sys.path if path.endswith("site-packages"))
    (site / "borrowed.pth").write_text(borrowed)
    code = "import igrip; print(igrip.__file__)"
    where = run(commands / "python", "-c", code, **outside(tmp_path))
    assert Path(where.strip()).is_relative_to(site)
    assert run(commands / "igrip", "--version", **outside(tmp_path)) == f"igrip {__version__}\n"
    assert '"igrip/1"' in run(commands / "igrip", "schema", "observation", **outside(tmp_path))
    assert "1 reaches" in run(commands / "igrip", *DEMO, **outside(tmp_path))


@pytest.mark.slow
def test_a_fresh_environment_needs_nothing_else(built: Distributions, tmp_path: Path) -> None:
    """With the dependencies from the index."""
    constraints = str(ROOT / "constraints.txt")
    commands = install(built.wheel, tmp_path / "venv", "--constraint", constraints)
    assert run(commands / "igrip", "--version", **outside(tmp_path)) == f"igrip {__version__}\n"
    assert "1 reaches" in run(commands / "igrip", *DEMO, **outside(tmp_path))
    assert "The core works." in run(commands / "igrip", "doctor", **outside(tmp_path))


@pytest.mark.slow
def test_the_source_distribution_passes_its_own_tests(built: Distributions, tmp_path: Path) -> None:
    with tarfile.open(built.sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    (folder,) = tmp_path.iterdir()
    tests = ("tests/cues", "tests/golden", "tests/benchmarks/test_tree.py", "tests/packaging")
    options = outside(folder)
    options["env"]["PYTHONPATH"] = str(folder / "src")
    assert " passed" in run(sys.executable, "-m", "pytest", "-q", *tests, **options)
