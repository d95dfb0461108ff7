"""A snapshot drawn in three dimensions: objects, hands, paths, rays (paper: Figure 4B)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from urllib.parse import quote, unquote

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.geometry.scene import PlacedObject
from igrip.viewer.snapshot import HandSnapshot, Snapshot, rays_of

COLOURS = (
    (236, 140, 60), (220, 70, 60), (240, 200, 70), (80, 175, 185), (150, 110, 80), (130, 100, 180),
    (110, 130, 90), (150, 150, 150),
)  # fmt: skip
TARGET = (60, 200, 90)
HANDS = {"left": (50, 90, 230), "right": (225, 45, 45)}
PAST, FUTURE, IMPACT = (200, 60, 60), (40, 160, 60), (220, 30, 200)
HIT, MISS = (215, 120, 205), (175, 175, 185)
KEEP_HIDDEN = 10.0  # seconds for which an absent hand or object is kept, hidden
RAY_STEP = 2  # every second ray is drawn: all of them would hide the target


class SceneDrawing:
    """Draws snapshots into a viser server.

    Attributes
    ----------
    colours : dict
        Colour of each drawn object by id: red, green, blue in 0-255.
    """

    def __init__(self, server: Any) -> None:
        self._scene = server.scene
        self._handles: dict[str, Any] = {}
        self._last_present: dict[str, float] = {}  # time of each hand and object [s]
        self.colours: dict[str, tuple[int, int, int]] = {}
        self._scene.set_up_direction("+z")
        self._scene.add_grid(
            "/table", width=1.6, height=1.6, cell_size=0.1, section_size=0.4,
            cell_color=(222, 219, 211), section_color=(200, 196, 186),
            plane_color=(245, 243, 238), plane_opacity=1.0, shadow_opacity=0.35,
        )  # fmt: skip
        server.initial_camera.position = (-0.33, -0.25, 0.47)
        server.initial_camera.look_at = (0.09, 0.27, 0.05)

    def draw(self, snapshot: Snapshot, rays: bool = True, only: str | None = None) -> None:
        """Draw a snapshot; path and rays of the hand ``only``, by default of all hands."""
        targets = {
            hand.target.id for hand in snapshot.hands
            if hand.target is not None and hand.intention.status in ("reaching", "holding")
            and only in (None, hand.intention.hand)
        }  # fmt: skip
        for placed in snapshot.objects:
            self._draw_object(placed, placed.id in targets)
        present = {_path("objects", placed.id) for placed in snapshot.objects}
        present |= {_path("hands", hand.intention.hand) for hand in snapshot.hands}
        self._forget(present, snapshot.t)
        for hand in snapshot.hands:
            shown = only in (None, hand.intention.hand)
            self._draw_hand(snapshot, hand, shown, shown and rays)

    def _forget(self, present: set[str], t: float) -> None:
        """Hide what is absent; remove it after a while, since its id may never return."""
        self._last_present |= dict.fromkeys(present, t)
        gone = {
            path for path, last in self._last_present.items() if not 0.0 <= t - last <= KEEP_HIDDEN
        }
        names = set(self._handles)
        for name in names:
            path = "/".join(name.split("/")[:3])
            if path in gone:
                handle = self._handles.pop(name)
                if name.rpartition("/")[0] not in names:  # otherwise its parent removes it
                    handle.remove()
            elif path not in present:
                self._handles[name].visible = False
        for path in gone:
            del self._last_present[path]
            self.colours.pop(unquote(path.split("/")[2]), None)

    def _draw_object(self, placed: PlacedObject, is_target: bool) -> None:
        name = _path("objects", placed.id)
        if placed.id not in self.colours:
            used = list(self.colours.values())
            self.colours[placed.id] = min(COLOURS, key=used.count)  # the rarest
        own = self.colours[placed.id]
        colour = TARGET if is_target else own
        model = placed.model
        mesh = self._handle(
            self._scene.add_mesh_simple, name, model.vertices.astype(np.float32), model.faces,
            color=colour,
        )  # fmt: skip
        label = self._handle(
            self._scene.add_label, f"{name}/label", placed.id, position=tuple(_top(placed)),
            anchor="bottom-center",
        )  # fmt: skip
        mesh.visible = label.visible = True
        mesh.wxyz = _wxyz(placed.rotation)
        mesh.position = placed.translation
        if tuple(mesh.color) != colour:
            mesh.color = colour

    def _draw_hand(self, snapshot: Snapshot, hand: HandSnapshot, shown: bool, rays: bool) -> None:
        id = hand.intention.hand
        path = _path("hands", id)
        colour = HANDS.get(id, (120, 120, 120))
        ball = self._handle(self._scene.add_icosphere, f"{path}/palm", radius=0.022, color=colour)
        label = self._handle(self._scene.add_label, f"{path}/label", id, anchor="bottom-center")
        ball.visible = label.visible = len(hand.past) > 0
        if len(hand.past):
            ball.position = hand.past[-1]
            label.position = hand.past[-1] + np.array([0.0, 0.0, 0.03])
        moving = hand.motion is not None and hand.intention.status == "reaching" and shown
        future = hand.motion.future if hand.motion is not None and moving else np.empty((0, 3))
        hits, misses = (
            rays_of(snapshot.scene, hand) if moving and rays else (np.empty((0, 2, 3)),) * 2
        )
        self._points(f"{path}/past", hand.past[:-1] if shown else hand.past[:0], PAST, 0.006)
        self._points(f"{path}/future", future, FUTURE, 0.010)
        self._points(f"{path}/impacts", hits[:, 1], IMPACT, 0.005)
        self._lines(f"{path}/hits", hits[::RAY_STEP], HIT)
        self._lines(f"{path}/misses", misses[::RAY_STEP], MISS)

    def _points(
        self, name: str, points: NDArray[np.float64], colour: tuple[int, ...], size: float
    ) -> None:
        cloud = self._handle(
            self._scene.add_point_cloud, name, np.zeros((1, 3), np.float32), colour,
            point_size=size, point_shape="circle", precision="float32",
        )  # fmt: skip
        _set_points(cloud, points)

    def _lines(self, name: str, segments: NDArray[np.float64], colour: tuple[int, ...]) -> None:
        lines = self._handle(
            self._scene.add_line_segments, name, np.zeros((1, 2, 3), np.float32), colour,
            thickness=1.0, thickness_units="screen",
        )  # fmt: skip
        _set_points(lines, segments)

    def _handle(self, add: Callable[..., Any], name: str, *shape: Any, **looks: Any) -> Any:
        """Return what is drawn under a name; add it if it is not there yet."""
        if name not in self._handles:
            self._handles[name] = add(name, *shape, **looks)
        return self._handles[name]


def _set_points(handle: Any, points: NDArray[np.float64]) -> None:
    handle.visible = len(points) > 0
    if len(points):
        handle.points = points.astype(np.float32)


def _path(kind: str, id: str) -> str:
    """Return a path in the page's tree; an id may contain any character, also a slash."""
    return f"/{kind}/{quote(id, safe='')}"


def _top(placed: PlacedObject) -> NDArray[np.float64]:
    """Return the upper end of the object's cylinder, in the mesh frame [m]."""
    model = placed.model
    up = 1.0 if (placed.rotation @ model.axis)[2] >= 0.0 else -1.0
    return model.origin + up * (0.5 * model.length + 0.01) * model.axis


def _wxyz(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    return np.array([w, x, y, z])
