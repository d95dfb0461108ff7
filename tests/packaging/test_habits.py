"""Version, changelog, pins and workflow agree with each other."""

import re
import tomllib
from datetime import date
from pathlib import Path

from igrip import __version__

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_the_newest_section_of_the_changelog_is_this_version_and_dated() -> None:
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    sections = re.findall(r"^## (.*)$", changelog, re.MULTILINE)
    released = [section for section in sections if section != "Unreleased"]
    version, day = re.fullmatch(r"(\S+) \((\S+)\)", released[0]).groups()
    assert version == __version__
    days = [date.fromisoformat(section[-11:-1]) for section in released]
    assert date.fromisoformat(day) == days[0]
    assert days == sorted(days, reverse=True)


def test_the_workflow_runs_every_python_that_is_promised() -> None:
    workflow = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    (versions,) = re.findall(r"python: \[(.*)\]", workflow)
    promised = re.findall(r"Python :: (3\.\d+)", "\n".join(PROJECT["classifiers"]))
    assert re.findall(r"3\.\d+", versions) == promised
    assert PROJECT["requires-python"] == f">={promised[0]}"


def test_pins_are_plain_and_cover_what_the_tests_need() -> None:
    pins = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    assert all(re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.]+", pin) for pin in pins)
    pinned = {re.sub(r"[-_.]+", "-", pin.partition("==")[0]).lower() for pin in pins}
    required = (ROOT / "requirements-test.txt").read_text(encoding="utf-8").splitlines()
    names = {name.lower() for name in required if name and not name.startswith("#")}
    for group in (PROJECT["dependencies"], *PROJECT["optional-dependencies"].values()):
        names |= {re.split(r"[^A-Za-z0-9._-]", requirement, maxsplit=1)[0] for requirement in group}
    assert {re.sub(r"[-_.]+", "-", name).lower() for name in names} <= pinned


def test_every_target_that_the_guides_name_is_in_the_makefile() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    for guide in ("README.md", "CONTRIBUTING.md"):
        text = (ROOT / guide).read_text(encoding="utf-8")
        named = set(re.findall(r"`?make ([a-z-]+)", text))
        assert named <= targets, guide
