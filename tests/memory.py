"""How much memory a process has, as on Linux."""

from __future__ import annotations

import re
from pathlib import Path


def resident(pid):
    """Return the memory of a process [MB]."""
    text = Path(f"/proc/{pid}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+)", text)[1]) / 1024.0
