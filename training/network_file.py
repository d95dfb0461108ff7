"""Files of networks: JSON as text that people can read and compare."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from igrip.motion.trajectory import Array


def write_network(head: Mapping[str, Any], arrays: Mapping[str, Array], path: Path) -> None:
    """Write a head, such as format and provenance, and one line for each array."""
    rows = [f' "{name}": {json.dumps(value.tolist())}' for name, value in arrays.items()]
    path.write_text(
        f"{json.dumps(head, indent=1)[:-2]},\n" + ",\n".join(rows) + "\n}\n", encoding="utf-8"
    )
