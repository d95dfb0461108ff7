"""Run the notebooks and keep what they show: ``make notebooks``."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient

NOTEBOOKS = Path(__file__).parents[1] / "notebooks"


def main() -> None:
    """Write the outputs of all notebooks into them."""
    os.environ["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        print(path.name, file=sys.stderr)
        notebook = nbformat.read(path, as_version=4)
        with tempfile.TemporaryDirectory() as folder:
            client = NotebookClient(notebook, timeout=600, record_timing=False,
                                    resources={"metadata": {"path": folder}})  # fmt: skip
            client.execute()
        nbformat.write(notebook, path)


if __name__ == "__main__":
    main()
