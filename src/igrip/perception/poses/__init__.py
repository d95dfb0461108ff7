"""Pose estimators: from a frame to poses of the catalogue's meshes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from igrip.entities import ObjectPose
from igrip.objects.catalog import Catalog
from igrip.registry import Registry
from igrip.rgbd import Array, RgbdFrame


class PoseEstimator(Protocol):
    """Estimates poses of objects; remembers them from frame to frame of the same camera."""

    def estimate(
        self, frame: RgbdFrame, hands: Sequence[Array] = ()
    ) -> Mapping[str, ObjectPose | None]:
        """Return the pose of each object that was found or looked for, by id.

        Parameters
        ----------
        frame : RgbdFrame
            Colour, and depth where the estimator needs it.
        hands : sequence of (21, 2) or (n, 2)
            Landmarks, or other points, of the hands in the picture [pixels]: what they cover
            is not the object.

        Returns
        -------
        mapping of str to ObjectPose or None
            World frame (``frame.world_from_camera``), metres, with ``model``, ``score``, ``source``
            and its own ``t``: the time of the frame in which it was last *visible*; an object that
            is hidden keeps its pose and its old ``t``. None: looked for where it was, and gone.
        """
        ...

    def close(self) -> None:
        """Release what it holds."""
        ...


POSES: Registry[Callable[[Catalog, Mapping[str, Any]], PoseEstimator]] = Registry(
    "pose estimator", "igrip.perception.poses", "igrip.poses"
)
"""By name; a member is called with the catalogue and its options (each documents its own; every
one has a default), and looks for the catalogue's models named in ``options["models"]``, or for all.
"""
