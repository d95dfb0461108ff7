"""A scan: views are gathered while a thing is turned, until it was seen from all sides."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import trimesh
from numpy.typing import NDArray

from igrip.errors import IgripError
from igrip.perception.registration.table import Table
from igrip.perception.scan.coverage import degrees_covered
from igrip.perception.scan.find import NO_TABLE, Sighting, Unseen, find_thing
from igrip.perception.scan.fuse import fused, surface_of
from igrip.perception.scan.joint import joined, polished
from igrip.perception.scan.options import ScanOptions
from igrip.perception.scan.planar_pose import PlanarPose, wrapped
from igrip.perception.scan.register import cloud_of, register
from igrip.perception.scan.revolve import views_all_round
from igrip.perception.scan.scan_view import ScanView, scan_view
from igrip.perception.scan.stillness import LastMoment, is_same
from igrip.perception.transforms import inverse, rigid
from igrip.rgbd import Array, RgbdFrame

AFTER_EACH = (0.006, 0.005, 0.004)  # gates of the rounds after each view [m]
WAIT = 0.3  # s between two looks at a thing that moves: each takes a while
ASKED = np.radians(30.0)  # turn, of a user
FULL = 360.0 - 0.5  # degrees
LOST = "it is not recognised after that turn: turn it back, and on in steps of about 30 degrees"
UNTURNED = (
    "it has not turned: turn it on, by about 30 degrees at a time, and take the hand away; a thing "
    "that looks the same from all sides needs --round"
)


class ScanError(IgripError):
    """A scan came to no end; the message says what to do."""


class Scanner:
    """Gathers views of one thing before one camera.

    Parameters
    ----------
    options : ScanOptions
        Its numbers.
    round_thing : bool
        Whether it looks the same from all sides: then one view is enough.

    Attributes
    ----------
    views : list of ScanView
        In poses of a frame on the table, z up.
    problem : str or None
        Why there is no new view just now, and what to do; None: nothing is wrong.
    camera : str
        Name of the camera.
    """

    def __init__(self, options: ScanOptions, round_thing: bool = False) -> None:
        self.options, self._round = options, round_thing
        self.views: list[ScanView] = []
        self.problem: str | None = None
        self.camera = ""
        self._table = Table()
        self._moment = LastMoment(options.settle)
        self._random = np.random.default_rng(options.seed)
        self._looked_at: Sighting | None = None  # and belonged nowhere
        self._tried = float("-inf")  # when a view was looked at [s]
        self._touched = False  # whether a hand may have turned it since the last look
        self._turns: list[float] = []  # between views [rad]
        self._progress: float | None = None  # when there was any, or none was due [s]

    @property
    def degrees(self) -> float:
        """How far round the thing was seen, at most 360."""
        if self._round:
            return 360.0 if self.views else 0.0
        return degrees_covered([view.pose.yaw for view in self.views], self.options.arc)

    @property
    def done(self) -> bool:
        """Whether it was seen from all sides."""
        return self.degrees >= FULL

    def add(self, frame: RgbdFrame, hands: Sequence[Array] = ()) -> bool:
        """Take a frame; return whether it brought a new view.

        ``hands`` are points on hands in the picture, (n, 2) each [pixels].

        Raises
        ------
        ScanError
            If the camera has no depth, or nothing has come of it for too long.
        """
        if frame.depth is None:
            raise ScanError("a scan needs a camera with depth, such as oak or realsense")
        self.camera = frame.camera
        new = self._add(frame, hands)
        if new or self._progress is None:
            self._progress = frame.t
        if frame.t - self._progress > self.options.patience:
            raise ScanError(f"nothing new for {self.options.patience:g} s: {self.missing()}")
        return new

    def missing(self) -> str:
        """Return what is missing, and what to do."""
        if not self.views or self.problem not in (None, UNTURNED):
            if self.problem is None:
                return "no hand must be at the thing for a moment: take it away, and wait"
            return self.problem
        if len(self.views) == 1:
            return UNTURNED
        return (
            f"only {self.degrees:.0f} of 360 degrees were seen: turn it on, all the way round, and "
            "scan again"
        )

    def mesh(self) -> trimesh.Trimesh:
        """Return the mesh of the thing: metres, z up, origin on the table under its middle.

        The poses of :attr:`views` are moved to that frame.

        Raises
        ------
        ScanError
            If it was not seen from all sides, or is not round though it was said to be.
        """
        if not self.done:
            raise ScanError(self.missing())
        if self._round:
            views = views_all_round(self.views[0])
            if views is None:
                raise ScanError(
                    "it does not look the same from all sides: turn it, without --round"
                )
            self.views = views
        else:
            views = joined(self.views, self._random)
            self.views = polished(views, cloud_of(views).centre)
        mesh = surface_of(fused(self.views, self.options.cell))
        middle = mesh.bounds.mean(axis=0)
        self.views = [
            view.placed(view.pose.moved(0.0, -float(middle[0]), -float(middle[1])))
            for view in self.views
        ]
        mesh.apply_translation([-middle[0], -middle[1], -mesh.bounds[0, 2]])
        return mesh

    def first_pose(self) -> Array:
        """Return where the thing stood in the first view: world-from-mesh, (4, 4)."""
        view = self.views[0]
        object_from_table = rigid(view.pose.rotation, view.pose.shift)
        stood = rigid(np.eye(3), (0.0, 0.0, self.options.stand))
        return np.asarray(self._table.world_from_table @ stood @ inverse(object_from_table))

    def picture(self) -> NDArray[np.uint8]:
        """Return the thing as the first view shows it, cropped to it, (h, w, 3)."""
        view = self.views[0]
        rows, columns = view.sighting.box
        return np.ascontiguousarray(view.colour[rows, columns])

    def _add(self, frame: RgbdFrame, hands: Sequence[Array]) -> bool:
        reach = (self.options.min_depth, self.options.max_depth)
        if not self._table.update(frame, reach, self._random, bool(self.views)):
            self.problem = NO_TABLE
            return False
        assert self._table.plane is not None
        if self._table.change is not None and self.views:
            raise ScanError("the camera or the table has moved: leave both as they are, scan again")
        options = self.options
        found = find_thing(frame, self._table.plane, hands, reach, options.stand, options.tolerance)
        if isinstance(found, Unseen):
            self._moment.clear()
            self._touched = self._touched or found.problem is None
            self.problem = found.problem
            return False
        self._moment.add(frame.t, found)
        self._touched = self._touched or self._moment.began
        best = self._moment.best()
        self._touched = self._touched or not self._moment.still
        if best is None or self._is_known(best):
            return False
        if not self._moment.still and frame.t - self._tried < WAIT:
            return False
        self._tried = frame.t
        view = scan_view(best, frame.colour, reach, PlanarPose(0.0, 0.0, 0.0))
        return self._first(view) if not self.views else self._next(view, best)

    def _is_known(self, sighting: Sighting) -> bool:
        """Whether it looks as when it was looked at last."""
        if self._looked_at is not None and is_same(self._looked_at, sighting):
            return True
        # what is round may look the same although a hand has turned it
        if self.views and not self._touched and is_same(self.views[-1].sighting, sighting):
            self.problem = UNTURNED
            return True
        return False

    def _expected(self) -> float | None:
        """Return the likeliest next turn [rad]; None: it was not turned yet."""
        if not self._turns:
            return None
        usual = float(np.median(self._turns[-5:]))
        # what is round seems to turn less than it does: then what the user was asked to do counts
        return float(np.copysign(ASKED, usual)) if self._moment.still else usual

    def _first(self, view: ScanView) -> bool:
        low, high = view.points[:, :2].min(axis=0), view.points[:, :2].max(axis=0)
        x, y = (float(value) for value in -0.5 * (low + high))
        self.views.append(view.placed(PlanarPose(0.0, x, y)))
        self.problem = None
        return True

    def _next(self, view: ScanView, sighting: Sighting) -> bool:
        found = register(view, self.views, self._expected(), self._random)
        self._touched = self._touched and not self._moment.still
        if found is None:
            self._looked_at = sighting
            self.problem = LOST if self._moment.still else None
            return False
        turn = wrapped(found.pose.yaw - self.views[-1].pose.yaw)
        if abs(turn) < np.radians(self.options.step):
            self._looked_at, self.problem = sighting, UNTURNED
            return False
        self._turns.append(turn)
        self.views = joined([*self.views, view.registered_at(found.pose)], self._random, AFTER_EACH)
        self._looked_at, self.problem = None, None
        return True
