"""Run every example, and write the gallery with its pictures: ``make gallery``."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
import tempfile
from pathlib import Path

DOCS = Path(__file__).parent
EXAMPLES = DOCS.parent / "examples"
PICTURES = DOCS / "pictures" / "gallery"


def title_of(example: Path) -> str:
    """Return the heading of an example: its name in words."""
    return example.stem[3:].replace("_", " ").capitalize()


def run(example: Path, *arguments: object) -> str:
    """Run an example and return what it prints.

    Raises
    ------
    subprocess.CalledProcessError
        If it fails.
    """
    done = subprocess.run(
        [sys.executable, example, *map(str, arguments)], check=True, stdout=subprocess.PIPE,
        text=True, env={**os.environ, "MPLBACKEND": "agg"},
    )  # fmt: skip
    return done.stdout.strip()


def main() -> None:
    """Write pictures, outputs and the page."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    page = ["# Gallery", "", "Every example is a file of `examples/` that runs as it stands:",
            "`python examples/04_probability_over_time.py picture.png`.",
            "`make gallery` runs them all and draws the pictures.", ""]  # fmt: skip
    for example in sorted(EXAMPLES.glob("*.py")):
        picture = PICTURES / f"{example.stem}.png"
        printed = run(example, picture).replace(f"{tempfile.gettempdir()}/", "")
        (DOCS / "output" / f"{example.stem}.txt").write_text(printed + "\n", encoding="utf-8")
        summary = (ast.get_docstring(ast.parse(example.read_text())) or "").splitlines()[0]
        page += [f"## {title_of(example)}", "", summary, "",
                 f"![{title_of(example)}](pictures/gallery/{picture.name})", "",
                 f'??? example "examples/{example.name}"', "", "    ``` { .python }",
                 f'    --8<-- "examples/{example.name}"', "    ```", "",
                 "    It prints:", "", "    ```text",
                 f'    --8<-- "docs/output/{example.stem}.txt"', "    ```", ""]  # fmt: skip
        print(example.name, file=sys.stderr)
    (DOCS / "gallery.md").write_text("\n".join(page), encoding="utf-8")


if __name__ == "__main__":
    main()
