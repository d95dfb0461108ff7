"""The page of commands names every command and shows today's help."""

import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from docs.make_commands import PAGE, run
from igrip.cli.app import COMMANDS


def test_the_page_names_every_command_and_no_other() -> None:
    headings = re.findall(r"^## igrip (\S+)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert headings == list(COMMANDS)


def test_the_page_shows_todays_help_of_every_command(tmp_path: Path) -> None:
    sections = re.split(r"^## igrip ", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    with ThreadPoolExecutor(2) as pool:
        helps = list(pool.map(lambda command: run(f"{command} --help", tmp_path), COMMANDS))
    for section, text in zip(sections, helps, strict=True):
        shown = section.partition("```text\n")[2].partition("\n```")[0]
        assert shown == text, f"run 'make commands': {section.splitlines()[0]} has changed"
