"""Make the report of a small cohort for the documentation: ``make report``."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent / "report"


def igrip(folder: str, *arguments: object) -> None:
    """Run the command in a folder, so that the report tells no path of this machine."""
    command = [sys.executable, "-m", "igrip", *map(str, arguments)]
    subprocess.run(command, check=True, cwd=folder)


def main() -> None:
    """Simulate, evaluate, and keep what the documentation shows."""
    HERE.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        cohort, out = "small cohort", Path(folder) / "report"
        igrip(folder, "simulate", cohort, "--participants", 11, "--trials", 8, "--no-reach", 4)
        igrip(folder, "evaluate", cohort, "--out", "report")
        for name in ("report.html", "summary.json"):
            shutil.copy(out / name, HERE / name)
        for name in ("participants", "accuracy", "courses"):
            shutil.copy(out / "figures" / f"{name}.png", HERE / f"{name}.png")


if __name__ == "__main__":
    main()
