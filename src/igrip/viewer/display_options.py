"""The display options on the page: the hand, the estimator and the panels to show."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from igrip.targets import TARGETS

ALL = "all"


class DisplayOptions:
    """The folder of display options on the page of a viser server.

    ``choose_targets`` is called with the name of another estimator, and without it the estimator
    cannot be changed; ``on_change`` when another hand, panel or part of the scene is to be shown.
    """

    def __init__(
        self,
        server: Any,
        targets: str | None,
        choose_targets: Callable[[str], None] | None,
        on_change: Callable[[], None],
    ) -> None:
        self._gui = server.gui
        self._on_change = on_change
        self._panels: dict[str, Any] = {}
        with self._gui.add_folder("Show"):
            self._hand = self._gui.add_dropdown("hand", (ALL,), hint="whose path and time courses")
            self._hand.on_update(lambda _: on_change())
            if targets is not None and choose_targets is not None:
                box = self._gui.add_dropdown(
                    "targets", tuple(TARGETS.names()), initial_value=targets,
                    hint="the estimator of the target",
                )  # fmt: skip
                box.on_update(lambda _: choose_targets(box.value))
            elif targets is not None:
                self._gui.add_text("targets", targets, disabled=True)
            self._rays = self._gui.add_checkbox("rays", True)
            self._rays.on_update(lambda _: on_change())
            self._boxes = self._gui.add_folder("panels", expand_by_default=False)

    @property
    def hand(self) -> str | None:
        """The chosen hand; None: all."""
        return None if self._hand.value == ALL else str(self._hand.value)

    @property
    def rays(self) -> bool:
        """Whether to draw rays."""
        return bool(self._rays.value)

    @property
    def hidden(self) -> list[str]:
        """The panels of time courses to hide."""
        return [name for name, box in self._panels.items() if not box.value]

    def set_hands(self, hands: Sequence[str]) -> None:
        """Offer these hands, and the chosen one."""
        options = (ALL, *sorted({*hands} | ({self._hand.value} - {ALL})))
        if options != tuple(self._hand.options):
            self._hand.options = options

    def add_panels(self, names: Sequence[str]) -> None:
        """Offer to hide these panels."""
        for name in names:
            if name not in self._panels:
                with self._boxes:
                    box = self._gui.add_checkbox(name.replace("_", " "), True)
                box.on_update(lambda _: self._on_change())
                self._panels[name] = box
