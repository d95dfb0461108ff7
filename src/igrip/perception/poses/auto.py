"""``auto``: known things by the names of their models (``depth``), all others as ``shapes``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from igrip.entities import ObjectPose
from igrip.errors import IgripError
from igrip.objects.catalog import Catalog
from igrip.perception.poses import POSES
from igrip.perception.poses.depth import DepthOptions, DepthPoses
from igrip.perception.poses.shapes import ShapesPoses
from igrip.perception.shapes.options import ShapesOptions
from igrip.rgbd import Array, RgbdFrame

SETTLED = 2.0  # s; what was in no catalogue for so long is not looked for in it again; guess


@POSES.register("auto")
class AutoPoses:
    """A :class:`igrip.perception.poses.PoseEstimator` of what is known and of what is not.

    ``options`` are those of :class:`igrip.perception.poses.depth.DepthOptions` and of
    :class:`igrip.perception.shapes.options.ShapesOptions`.

    Raises
    ------
    IgripError
        If an option is unknown or wrong, or a file cannot be read.
    UnknownModelError
        If the catalogue lacks a model that is named.
    """

    def __init__(
        self, catalog: Catalog, options: Mapping[str, Any] | None = None,
        shapes: ShapesPoses | None = None,
    ) -> None:  # fmt: skip
        self._catalog, self._options = catalog, dict(options or {})
        for_depth, for_shapes = _divided(self._options)
        self._known = DepthPoses(catalog, for_depth)
        self._unknown = shapes or ShapesPoses(catalog, for_shapes)

    def sibling(self) -> AutoPoses:
        """Return one for another camera, to which the same things have the same ids."""
        return AutoPoses(self._catalog, self._options, self._unknown.sibling())

    def estimate(
        self, frame: RgbdFrame, hands: Sequence[Array] = ()
    ) -> Mapping[str, ObjectPose | None]:
        """Return the pose of each object; see :class:`igrip.perception.poses.PoseEstimator`.

        Raises
        ------
        IgripError
            If the frame has no depth.
        """
        if frame.depth is None:
            raise IgripError("the pose estimator 'auto' needs a camera with depth; or use 'tags'")
        settled = self._unknown.settled_fits(frame.camera, frame.t - SETTLED)
        poses = dict(self._known.estimate(frame, hands, settled))
        known = self._known.visible_fits(frame.camera)
        return poses | dict(self._unknown.estimate(frame, hands, known))

    def give_name(self, id: str, name: str) -> None:
        """Give an unknown thing a name; see :meth:`ShapesPoses.give_name`."""
        self._unknown.give_name(id, name)

    def close(self) -> None:
        """Forget all cameras; write the file of names, if there is none yet."""
        self._known.close()
        self._unknown.close()


def _divided(options: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the options of either estimator; one that both have goes to both."""
    ours = set(ShapesOptions.model_fields)
    theirs = set(DepthOptions.model_fields)
    unknown = set(options) - ours - theirs
    # what neither knows is reported by the first
    for_depth = {key: value for key, value in options.items() if key in theirs | unknown}
    return for_depth, {key: value for key, value in options.items() if key in ours}
