"""Names for unknown things, given on the page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from igrip.errors import IgripError
from igrip.viewer.server import Viewer


class NamingPanel:
    """Offers a field for the name of each unknown thing.

    Parameters
    ----------
    viewer : Viewer
        The page.
    give_name : function
        Called, from another thread, with the id of a thing and its new name; an IgripError says
        why not.
    """

    def __init__(self, viewer: Viewer, give_name: Callable[[str, str], None]) -> None:
        self._viewer, self._give_name = viewer, give_name
        self._ids: list[str] = []
        self._names: dict[str, str] = {}
        viewer.handle("name", self._receive)

    def set_things(self, ids: Sequence[str]) -> None:
        """Offer names for these things; those that are gone stay, in case they come back."""
        new = [id for id in ids if id not in self._ids]
        if new:
            self._ids += new
            self._publish("")

    def _receive(self, asked: Any) -> None:
        id, name = asked["id"], asked["name"]
        if not isinstance(name, str) or id not in self._ids:
            raise ValueError("not a thing and a name")
        try:
            self._give_name(id, name)
        except IgripError as error:
            self._publish(f"Not named: {error}")
            return
        self._names[id] = " ".join(name.split())
        self._publish(f"{id} is {self._names[id]} from the next run on.")

    def _publish(self, answer: str) -> None:
        self._viewer.publish(
            "things", {"ids": list(self._ids), "names": dict(self._names), "answer": answer}
        )
