"""``shapes``: whatever stands on the table and is no arm, without a model known before.

How it works, and what was measured: docs/unknown-objects.md.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from igrip.entities import ObjectPose
from igrip.errors import IgripError
from igrip.objects.catalog import Catalog
from igrip.perception.options import validated
from igrip.perception.poses import POSES
from igrip.perception.registration.fit import PoseFit
from igrip.perception.shapes.memory import Memory
from igrip.perception.shapes.names import give_name, read_names, write_names
from igrip.perception.shapes.options import ShapesOptions
from igrip.perception.shapes.things import Things
from igrip.perception.transforms import object_pose, rigid
from igrip.rgbd import Array, RgbdFrame


@POSES.register("shapes")
class ShapesPoses:
    """A :class:`igrip.perception.poses.PoseEstimator` of things without a model.

    Their models are put into the catalogue, under their ids. ``options`` are the fields of
    :class:`igrip.perception.shapes.options.ShapesOptions`.

    Raises
    ------
    IgripError
        If an option is unknown or wrong, or the file of names cannot be read.
    """

    def __init__(
        self, catalog: Catalog, options: Mapping[str, Any] | None = None,
        memory: Memory | None = None,
    ) -> None:  # fmt: skip
        self.options = validated(ShapesOptions, "shapes", options or {})
        self._catalog, self._raw = catalog, options
        self.memory = memory or Memory(catalog)
        path = self.options.names
        self._names = () if path is None else read_names(path, catalog)
        self._cameras: dict[str, Things] = {}
        self._random = np.random.default_rng(self.options.seed)

    def sibling(self) -> ShapesPoses:
        """Return one for another camera, to which the same things have the same ids."""
        return ShapesPoses(self._catalog, self._raw, self.memory)

    def estimate(
        self, frame: RgbdFrame, hands: Sequence[Array] = (), known: Sequence[PoseFit] = ()
    ) -> Mapping[str, ObjectPose | None]:
        """Return the pose of each thing; see :class:`igrip.perception.poses.PoseEstimator`.

        ``known`` are objects of the catalogue in this frame, world-from-mesh: they are no things.

        Raises
        ------
        IgripError
            If the frame has no depth.
        """
        if frame.depth is None:
            raise IgripError("the pose estimator 'shapes' needs a camera with depth; or use 'tags'")
        things = self._cameras.get(frame.camera)
        if things is None:
            things = Things(self.memory, self._names, self.options, self._random)
            self._cameras[frame.camera] = things
        things.update(frame, hands, known)
        poses: dict[str, ObjectPose | None] = dict.fromkeys(things.gone)
        for id, thing in things.followed.items():
            fit = thing.track.fit
            poses[id] = object_pose(
                rigid(*fit.pose.after(things.table.world_from_table)), model=id, t=thing.track.t,
                std=float(np.hypot(fit.std, thing.std)), score=min(1.0, fit.agreement),
                source="shapes",
            )  # fmt: skip
        return poses

    def settled_fits(self, camera: str, since: float) -> list[PoseFit]:
        """Return the visible things that a camera has followed since a time [s], world-from-mesh.

        So long that they would have been found in the catalogue, if they were in it.
        """
        things = self._cameras.get(camera)
        if things is None:
            return []
        world = things.table.world_from_table
        return [
            replace(thing.track.fit, pose=thing.track.fit.pose.after(world))
            for thing in things.followed.values()
            if thing.track.state == "visible" and thing.born <= since
        ]  # fmt: skip

    def give_name(self, id: str, name: str) -> None:
        """Give a thing a name, in the file of names; it has it from the next run on.

        May be called from another thread.

        Raises
        ------
        IgripError
            If there is no such thing or no file, or the name cannot be used.
        """
        thing = self.memory.things().get(id)
        if thing is None:
            raise IgripError(f"there is no unknown thing {id!r}")
        if self.options.names is None:
            raise IgripError("names need a file: start with --option names=names.toml")
        give_name(self.options.names, id, name, thing.look, self._catalog)

    def close(self) -> None:
        """Forget all cameras; write the file of names, if there is none yet."""
        path = self.options.names
        looks = {id: thing.look for id, thing in self.memory.things().items()}
        if path is not None and looks and not Path(path).exists():
            write_names(path, looks)
        self._cameras.clear()
