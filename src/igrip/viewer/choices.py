"""What a person chooses on the page: which hand, which estimator, which panels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from igrip.targets import TARGETS

ALL = "all"


class Choices:
    """The folder of choices.

    Parameters
    ----------
    server : viser.ViserServer
        Of the page.
    targets : str or None
        Name of the estimator that is at work.
    choose_targets : function or None
        Called with the name of another; without it there is no such choice.
    changed : function
        Called when something else is to be shown.
    """

    def __init__(
        self,
        server: Any,
        targets: str | None,
        choose_targets: Callable[[str], None] | None,
        changed: Callable[[], None],
    ) -> None:
        self._gui = server.gui
        self._changed = changed
        self._panels: dict[str, Any] = {}
        with self._gui.add_folder("Show"):
            self._hand = self._gui.add_dropdown("hand", (ALL,), hint="whose path and time courses")
            self._hand.on_update(lambda _: changed())
            if targets is not None and choose_targets is not None:
                box = self._gui.add_dropdown(
                    "targets", tuple(TARGETS.names()), initial_value=targets,
                    hint="the estimator of the target",
                )  # fmt: skip
                box.on_update(lambda _: choose_targets(box.value))
            elif targets is not None:
                self._gui.add_text("targets", targets, disabled=True)
            self._rays = self._gui.add_checkbox("rays", True)
            self._rays.on_update(lambda _: changed())
            self._boxes = self._gui.add_folder("panels", expand_by_default=False)

    @property
    def hand(self) -> str | None:
        """The chosen hand; None: all."""
        return None if self._hand.value == ALL else str(self._hand.value)

    @property
    def rays(self) -> bool:
        """Whether rays are drawn."""
        return bool(self._rays.value)

    @property
    def hidden(self) -> list[str]:
        """Panels of time courses that are not wanted."""
        return [name for name, box in self._panels.items() if not box.value]

    def offer(self, hands: Sequence[str]) -> None:
        """Let these hands be chosen, and the one that is."""
        options = (ALL, *sorted({*hands} | ({self._hand.value} - {ALL})))
        if options != tuple(self._hand.options):
            self._hand.options = options

    def offer_panels(self, names: Sequence[str]) -> None:
        """Let these panels be shown or hidden."""
        for name in names:
            if name not in self._panels:
                with self._boxes:
                    box = self._gui.add_checkbox(name.replace("_", " "), True)
                box.on_update(lambda _: self._changed())
                self._panels[name] = box
