"""The scene in a browser, by viser: what was decided, drawn beside the estimator.

The estimator hands over one snapshot at a time and never waits: while one is drawn, newer ones
replace each other, and the older are dropped and counted.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from urllib.parse import quote

import numpy as np
import rich
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.errors import MissingExtraError
from igrip.geometry.scene import Placed, Scene
from igrip.viewer.snapshot import HandSnapshot, Snapshot, rays_of
from igrip.words import describe

log = logging.getLogger(__name__)

COLOURS = (
    (236, 140, 60), (220, 70, 60), (240, 200, 70), (90, 150, 210), (110, 180, 110), (170, 120, 200),
)  # fmt: skip
TARGET = (60, 200, 90)
HANDS = {"left": (50, 90, 230), "right": (225, 45, 45)}
PAST, FUTURE, IMPACT, RAY = (200, 60, 60), (40, 160, 60), (220, 30, 200), (90, 90, 100)
DRAWN = 3  # one ray in three is drawn: all of them would hide what they point at


class Viewer:
    """A page with the live scene.

    Parameters
    ----------
    scene : Scene
        The estimator's geometry, whose rays are drawn.
    host, port : str, int
        Where to listen; the next free port is taken where this one is not.

    Attributes
    ----------
    dropped : int
        Snapshots that were replaced by newer ones before they were drawn.

    Raises
    ------
    MissingExtraError
        If viser is not installed.
    """

    def __init__(self, scene: Scene, host: str = "127.0.0.1", port: int = 8080) -> None:
        try:
            import viser
        except ImportError as error:
            raise MissingExtraError("viser", "viewer", "the scene in the browser") from error
        self._scene = scene
        with _quiet():
            self._server: Any = viser.ViserServer(host, port, label="igrip", verbose=False)
        self._handles: dict[str, Any] = {}
        self._newest: Snapshot | None = None
        self._wake = threading.Condition()
        self._closed = False
        self.dropped = 0
        self.drawn = 0
        self._prepare()
        self._thread = threading.Thread(target=self._run, name="igrip-viewer", daemon=True)
        self._thread.start()

    @property
    def url(self) -> str:
        """Address of the page."""
        return f"http://localhost:{self._server.get_port()}"

    def show(self, snapshot: Snapshot | None) -> None:
        """Hand over the newest moment; returns at once."""
        if snapshot is None:
            return
        with self._wake:
            self.dropped += self._newest is not None
            self._newest = snapshot
            self._wake.notify()

    def close(self) -> None:
        """Stop drawing and close the page's server."""
        with self._wake:
            self._closed = True
            self._wake.notify()
        self._thread.join(timeout=5.0)
        with _quiet():
            self._server.stop()

    def note(self, text: str) -> None:
        """Show a line of text above the hands, for example the task of a demo."""
        self._handles["note"].content = text

    def _prepare(self) -> None:
        server = self._server
        server.gui.configure_theme(show_logo=False, show_share_button=False, control_width="medium")
        server.gui.set_panel_label("igrip")
        server.scene.set_up_direction("+z")
        server.scene.add_grid(
            "/table", width=1.6, height=1.6, cell_size=0.1, section_size=0.4,
            cell_color=(225, 222, 214), section_color=(205, 200, 190),
            plane_color=(245, 243, 238), plane_opacity=1.0, shadow_opacity=0.2,
        )  # fmt: skip
        server.initial_camera.position = (-0.36, -0.38, 0.52)
        server.initial_camera.look_at = (0.03, 0.3, 0.05)
        self._handles["note"] = server.gui.add_markdown("")
        self._handles["words"] = server.gui.add_markdown("*no hand yet*")
        server.gui.add_markdown(
            "Large spheres: hands. Small red: where a hand was; green: where it is expected in the "
            "next 0.3 s. Lines: some of the rays towards the target; magenta: where they meet it."
        )

    def _run(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._closed or self._newest is not None)
                if self._closed:
                    return
                snapshot, self._newest = self._newest, None
            assert snapshot is not None
            try:
                with self._server.atomic():
                    self._draw(snapshot)
            except Exception:  # a moment that cannot be drawn must not end the page
                log.exception("a moment at t = %.3f s was not drawn", snapshot.t)
            self.drawn += 1

    def _draw(self, snapshot: Snapshot) -> None:
        targets = {
            hand.target.id for hand in snapshot.hands
            if hand.target is not None and hand.intention.status == "reaching"
        }  # fmt: skip
        for index, placed in enumerate(snapshot.objects):
            self._draw_object(placed, index, placed.id in targets)
        present = {_path("objects", placed.id) for placed in snapshot.objects}
        for name, handle in self._handles.items():
            if name.startswith("/objects/"):
                handle.visible = name.removesuffix("/label") in present
        for hand in snapshot.hands:
            self._draw_hand(hand)
        lines = [f"- {describe(hand.intention)}" for hand in snapshot.hands]
        self._handles["words"].content = f"**t = {snapshot.t:.2f} s**\n\n" + "\n".join(lines)

    def _draw_object(self, placed: Placed, index: int, is_target: bool) -> None:
        name = _path("objects", placed.id)
        colour = TARGET if is_target else COLOURS[index % len(COLOURS)]
        if name not in self._handles:
            self._handles[name] = self._server.scene.add_mesh_simple(
                name, placed.model.vertices.astype(np.float32), placed.model.faces, color=colour
            )
            self._handles[f"{name}/label"] = self._server.scene.add_label(
                f"{name}/label", placed.id, position=tuple(_top(placed)), anchor="bottom-center"
            )
        handle = self._handles[name]
        handle.wxyz = _wxyz(placed.rotation)
        handle.position = placed.translation
        if tuple(handle.color) != colour:
            handle.color = colour

    def _draw_hand(self, hand: HandSnapshot) -> None:
        id = hand.intention.hand
        path = _path("hands", id)
        colour = HANDS.get(id, (120, 120, 120))
        reaching = hand.intention.status == "reaching"
        ball = self._handle(
            f"{path}/palm",
            lambda name: self._server.scene.add_icosphere(name, radius=0.025, color=colour),
        )
        ball.visible = len(hand.past) > 0
        if len(hand.past):
            ball.position = hand.past[-1]
        moving = hand.motion is not None and reaching
        future = hand.motion.future if hand.motion is not None and moving else np.empty((0, 3))
        segments, impacts = rays_of(self._scene, hand) if moving else (np.empty((0, 2, 3)),) * 2
        self._points(f"{path}/past", hand.past[:-1], PAST, 0.012)
        self._points(f"{path}/future", future, FUTURE, 0.014)
        self._points(f"{path}/impacts", impacts.reshape(-1, 3), IMPACT, 0.006)
        self._lines(f"{path}/rays", segments[::DRAWN])

    def _points(
        self, name: str, points: NDArray[np.float64], colour: tuple[int, ...], size: float
    ) -> None:
        handle = self._handle(
            name,
            lambda name: self._server.scene.add_point_cloud(
                name, np.zeros((1, 3), np.float32), colour, point_size=size,
                point_shape="sparkle" if size < 0.01 else "circle", precision="float32",
            ),
        )  # fmt: skip
        handle.visible = len(points) > 0
        if len(points):
            handle.points = points.astype(np.float32)

    def _lines(self, name: str, segments: NDArray[np.float64]) -> None:
        handle = self._handle(
            name,
            lambda name: self._server.scene.add_line_segments(
                name, np.zeros((1, 2, 3), np.float32), RAY, thickness=1.0, thickness_units="screen"
            ),
        )
        handle.visible = len(segments) > 0
        if len(segments):
            handle.points = segments.astype(np.float32)

    def _handle(self, name: str, make: Any) -> Any:
        if name not in self._handles:
            self._handles[name] = make(name)
        return self._handles[name]


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep viser's banners off standard output, where a program may read our answer."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before


def _path(kind: str, id: str) -> str:
    """Return a name in the page's tree; an id may hold any character, a slash among them."""
    return f"/{kind}/{quote(id, safe='')}"


def _top(placed: Placed) -> NDArray[np.float64]:
    """Return the end of the object's cylinder that is higher in the world, mesh frame [m]."""
    model = placed.model
    up = 1.0 if (placed.rotation @ model.axis)[2] >= 0.0 else -1.0
    return model.origin + up * (0.5 * model.length + 0.01) * model.axis


def _wxyz(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    return np.array([w, x, y, z])
