"""What is imported, and when: no times are taken here (``python -m benchmarks.startup`` does)."""

import importlib
import json
import subprocess
import sys

import pytest
import typer

from igrip.cli.app import COMMANDS, RENAMED_OPTIONS, app, target_of

HEAVY = {"numpy", "scipy", "numba", "trimesh", "pydantic", "msgspec", "rich"}
FAMILIES = {
    "igrip.cues": "CUES",
    "igrip.targets": "TARGETS",
    "igrip.grips": "GRIPS",
    "igrip.io.recordings": "SOURCES",
    "igrip.io.importers": "IMPORTERS",
    "igrip.perception.cameras": "CAMERAS",
    "igrip.perception.hands": "HANDS",
    "igrip.perception.poses": "POSES",
    "igrip.runtime.inputs": "INPUTS",
    "igrip.runtime.outputs": "OUTPUTS",
}
RUN = """
import json, runpy, sys
sys.argv[0] = "igrip"
try:
    runpy.run_module("igrip", run_name="__main__")
except SystemExit as exit:
    assert exit.code == 0, exit.code
print(json.dumps(list(sys.modules)), file=sys.stderr)
"""


def modules_after(code: str, *arguments: str) -> set[str]:
    """Return the names of the modules that a fresh process has imported after running code."""
    command = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stderr.splitlines()[-1]))


def commands_in(modules: set[str]) -> set[str]:
    return {name for name in COMMANDS if target_of(name)[0] in modules}


def test_import_igrip_is_light() -> None:
    code = "import igrip, json, sys; print(json.dumps(list(sys.modules)), file=sys.stderr)"
    modules = modules_after(code)
    assert "igrip" in modules
    assert not modules & HEAVY


@pytest.mark.parametrize("arguments", [("--help",), ("--version",)])
def test_help_and_version_import_no_command(arguments: tuple[str, ...]) -> None:
    modules = modules_after(RUN, *arguments)
    assert "igrip.cli.app" in modules
    assert not modules & HEAVY
    assert commands_in(modules) == set()


@pytest.mark.parametrize("name", ["doctor", "schema"])
def test_a_command_imports_no_other(name: str) -> None:
    """The import contract holds this for all commands; here it is tried."""
    assert commands_in(modules_after(RUN, name, "--help")) == {name}


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_of_a_command_is_the_first_line_of_its_docstring(name: str) -> None:
    module, function = target_of(name)
    command = getattr(importlib.import_module(module), function)
    # a group of commands has its help where a command has its docstring
    text = command.info.help if isinstance(command, typer.Typer) else command.__doc__
    assert COMMANDS[name] == text.splitlines()[0]


def test_a_mistyped_command_gets_a_suggestion() -> None:
    command = [sys.executable, "-m", "igrip", "evaluat"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert done.returncode == 2
    assert "Did you mean 'evaluate'?" in done.stderr


@pytest.mark.parametrize("package", FAMILIES)
def test_listing_the_names_of_a_family_imports_no_member(package: str) -> None:
    code = (
        f"import importlib, json, sys; registry = importlib.import_module({package!r})."
        f"{FAMILIES[package]}; print(json.dumps([registry.names(), list(sys.modules)]))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    names, modules = json.loads(done.stdout)
    assert names
    assert not {f"{package}.{name}" for name in names} & set(modules)


@pytest.mark.parametrize("command", RENAMED_OPTIONS)
def test_a_renamed_option_is_gone_and_its_new_name_exists(command: str) -> None:
    group = typer.main.get_command(app)
    options = {o for p in group.get_command(None, command).params for o in p.opts}
    for old, new in RENAMED_OPTIONS[command].items():
        assert old not in options
        assert new in options
