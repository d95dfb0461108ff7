"""The page of a live scene, where the extra for it is installed."""

from __future__ import annotations

from typing import Any

from igrip.cli.console import errors, warn
from igrip.errors import MissingExtraError
from igrip.viewer.server import Viewer


def open_page(port: int, **options: Any) -> Viewer | None:
    """Open the page and print its address; None where a package for it is missing."""
    try:
        viewer = Viewer(port=port, **options)
    except MissingExtraError as error:
        warn(f"{error}; continuing without the page")
        return None
    errors.print(f"The scene is live at {viewer.url}")
    return viewer
