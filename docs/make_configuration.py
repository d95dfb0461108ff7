"""Make docs/configuration.md: every number of a Config, with unit, meaning and source.

Run it as ``python docs/make_configuration.py``; a test compares the page with the code.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from igrip import Config

HEAD = (
    "# Every number of a configuration\n\n"
    '`Config(motion={"reach": {"onset_distance": 0.01}})` changes one. A misspelt key is an error, '
    "and the error for a key of an earlier version names the new one. This page is made by "
    "`docs/make_configuration.py`.\n\n"
    "| key | default | unit | meaning | source |\n| --- | --- | --- | --- | --- |\n"
)


def rows(settings: BaseModel, path: str = "") -> Iterator[str]:
    """Yield a line of the table for each number."""
    for name, field in type(settings).model_fields.items():
        default = getattr(settings, name)
        if isinstance(default, BaseModel):
            yield from rows(default, f"{path}{name}.")
        elif isinstance(default, int | float) and not isinstance(default, bool):
            extra: Any = field.json_schema_extra
            meaning = str(field.description).removesuffix(f" [{extra['unit']}]")
            cells = (f"`{path}{name}`", f"{default:.5g}", extra["unit"], meaning, extra["source"])
            yield f"| {' | '.join(cells)} |\n"


if __name__ == "__main__":
    Path(__file__).with_name("configuration.md").write_text(HEAD + "".join(rows(Config())))
