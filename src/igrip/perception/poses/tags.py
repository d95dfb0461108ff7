"""Objects by AprilTags stuck to them: poses from colour alone.

A flipped pose is worse than none: where one small tag is seen from afar and nothing tells its two
poses apart, the object keeps its last pose and that pose's time.
"""

from __future__ import annotations

import tomllib
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from igrip.entities import ObjectPose, Quaternion, Vector
from igrip.errors import IgripError
from igrip.objects.catalog import Catalog
from igrip.perception.poses import POSES
from igrip.perception.tags import TagDetector, TagPlace, TagPose, TagSeen, choose, tag_poses
from igrip.rgbd import RgbdFrame
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]

NEARER = 0.03  # m: what is so much nearer than a tag hides it; guess


class TagOptions(Settings):
    """One tag on an object.

    Attributes
    ----------
    model : str
        Of the catalogue.
    id : str or None
        Of the object; by default the model's name.
    position, orientation : 3 and 4 floats
        Pose of the tag in the mesh's own frame [m], quaternion x, y, z, w. The tag's frame: centre,
        x to the right, y up, z out of it.
    upright : bool
        The object stands upright whenever it is seen: this decides between two poses.
    """

    model: str
    id: str | None = None
    size: float = quantity(..., "m", "edge of the tag's black square", gt=0.0, le=1.0)
    position: Vector = (0.0, 0.0, 0.0)
    orientation: Quaternion = (0.0, 0.0, 0.0, 1.0)
    upright: bool = False


class TagsOptions(Settings):
    """The options of the pose finder ``tags``.

    Attributes
    ----------
    tags : mapping of int to TagOptions
        By number; in a TOML file: tables ``[tags.7]``.
    models : tuple of str or None
        Only these models are looked for.
    family : str
        Of all tags.
    up : 3 floats
        Up in the world; counts for objects that are ``upright``.
    """

    tags: dict[int, TagOptions]
    models: tuple[str, ...] | None = None
    family: str = "tag36h11"
    up: Vector = (0.0, 0.0, 1.0)
    decimate: float = quantity(2.0, "1", "tags are looked for in a smaller picture", "docs/tags.md")
    lasting: float = quantity(
        0.3, "s", "a pose this old still tells two poses apart", "guess", ge=0
    )
    missing: float = quantity(
        1.0, "s", "an object in plain view that was not seen for so long is not there", "guess",
        gt=0,
    )  # fmt: skip


class _Known(NamedTuple):
    world_from_object: Array
    t: float
    said: ObjectPose


@POSES.register("tags")
class TagPoses:
    """Poses of tagged objects.

    Parameters
    ----------
    catalog : Catalog
        The objects.
    options : mapping
        The fields of :class:`TagsOptions`; ``tags`` may be the path of a TOML file, whose other
        keys are options, too.

    Raises
    ------
    IgripError
        If the options cannot be read or contradict each other.
    UnknownModelError
        If a tag is on a model that the catalogue does not have.
    MissingExtraError
        If pupil-apriltags or OpenCV is not installed.
    """

    def __init__(self, catalog: Catalog, options: Mapping[str, Any]) -> None:
        self._options = read_options(options)
        self._places: dict[str, dict[int, TagPlace]] = defaultdict(dict)
        self._models: dict[str, str] = {}
        self._upright: dict[str, bool] = {}
        wanted = self._options.models
        for number, tag in self._options.tags.items():
            catalog[tag.model]
            if wanted is not None and tag.model not in wanted:
                continue
            name = tag.id or tag.model
            if self._models.setdefault(name, tag.model) != tag.model:
                raise IgripError(f"tag {number}: {name!r} is of two models")
            self._upright[name] = self._upright.get(name, False) or tag.upright
            self._places[name][number] = TagPlace(tag.size, _matrix(tag.position, tag.orientation))
        self._detector = TagDetector(self._options.family, self._options.decimate)
        self._known: dict[tuple[str, str], _Known] = {}

    def find(
        self, frame: RgbdFrame, hands: Sequence[Array] = ()
    ) -> Mapping[str, ObjectPose | None]:
        """Return the pose of each tagged object; see :class:`igrip.perception.poses.PoseEstimator`.

        ``score`` is the probability that the pose is not the flipped one.
        """
        seen = {tag.id: tag for tag in self._detector.find(frame)}
        found: dict[str, ObjectPose | None] = {}
        for name, places in self._places.items():
            key = (frame.camera, name)
            known = self._known.get(key)
            if known is not None and frame.t < known.t:  # another run
                del self._known[key]
                known = None
            tags = [seen[number] for number in places if number in seen]
            fit = self._decide(frame, name, tags, known)
            if fit is not None:
                known = self._known[key] = self._say(frame, name, *fit)
            if known is None:
                continue
            found[name] = known.said
            gone = not tags and frame.t - known.t > self._options.missing
            if gone and self._in_plain_view(frame, places, known, hands):
                found[name] = None
                del self._known[key]
        return found

    def close(self) -> None:
        """Let go of what is known."""
        self._known.clear()

    def _decide(
        self, frame: RgbdFrame, name: str, tags: list[TagSeen], known: _Known | None
    ) -> tuple[TagPose, float] | None:
        camera_from_world = np.linalg.inv(frame.world_from_camera)
        before = up = None
        if known is not None and frame.t - known.t <= self._options.lasting:
            before = camera_from_world @ known.world_from_object
        # a camera that was never placed knows no up
        if self._upright[name] and not np.array_equal(frame.world_from_camera, np.eye(4)):
            up = np.array([0.0, 0.0, 1.0]), camera_from_world[:3, :3] @ self._options.up
        return choose(tag_poses(tags, self._places[name], frame.intrinsics), before, up)

    def _say(self, frame: RgbdFrame, name: str, fit: TagPose, probability: float) -> _Known:
        pose = frame.world_from_camera @ fit.pose
        turn = frame.world_from_camera[:3, :3]
        x, y, z = pose[:3, 3].tolist()
        a, b, c, d = Rotation.from_matrix(pose[:3, :3]).as_quat().tolist()
        sx, sy, sz = np.sqrt(np.diag(turn @ fit.covariance @ turn.T)).tolist()
        said = ObjectPose(
            position=(x, y, z),
            orientation=(a, b, c, d),
            model=self._models[name],
            t=frame.t,
            std=(sx, sy, sz),
            score=probability,
            source="tags",
        )
        return _Known(pose, frame.t, said)

    def _in_plain_view(
        self, frame: RgbdFrame, places: Mapping[int, TagPlace], known: _Known,
        hands: Sequence[Array],
    ) -> bool:  # fmt: skip
        """Whether a tag would have to be seen if the object still were where it was."""
        pose = np.linalg.inv(frame.world_from_camera) @ known.world_from_object
        height, width = frame.colour.shape[:2]
        for place in places.values():
            tag = pose @ place.thing_from_tag
            at = tag[:3, 3]
            if at[2] <= 0.0 or tag[:3, 2] @ at > -0.5 * float(np.linalg.norm(at)):
                continue  # it faces away, or nearly
            corners = place.corners @ pose[:3, :3].T + pose[:3, 3]
            pixels = frame.intrinsics.pixels(corners)
            if (pixels < 0).any() or (pixels >= [width, height]).any():
                continue
            margin = float(np.ptp(pixels, axis=0).max())
            if margin < 20.0 or any(_beside(pixels, hand, margin) for hand in hands):
                continue
            if frame.depth is not None:
                u, v = np.round(pixels.mean(axis=0)).astype(int)
                if 0.0 < frame.depth[v, u] < at[2] - NEARER:
                    continue
            return True
        return False


def _beside(pixels: Array, hand: Array, margin: float) -> bool:
    """Whether a hand, (21, 2), may cover corners, (4, 2): its box, grown, meets theirs."""
    low, high = hand.min(axis=0) - margin, hand.max(axis=0) + margin
    return bool((pixels.max(axis=0) >= low).all() and (pixels.min(axis=0) <= high).all())


def _matrix(position: Vector, orientation: Quaternion) -> Array:
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_quat(orientation).as_matrix()
    pose[:3, 3] = position
    return pose


def read_options(options: Mapping[str, Any]) -> TagsOptions:
    """Read the options, and the file that ``tags`` may name."""
    given = dict(options)
    if isinstance(given.get("tags"), str | Path):
        path = Path(given.pop("tags"))
        try:
            given = tomllib.loads(path.read_text("utf-8")) | given
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise IgripError(f"{path}: cannot be read: {error}") from error
    if not given.get("tags"):
        raise IgripError(
            "the pose finder 'tags' needs to know which tags are on what: options tags = "
            '{7: {"model": "006_mustard_bottle", "size": 0.03, "position": …, "orientation": …}}'
            ", or the path of a TOML file with tables [tags.7]"
        )
    try:
        read = TagsOptions(**given)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise IgripError(f"tags: {where}: {first['msg']}") from error
    for number, tag in read.tags.items():
        if not 0.99 < float(np.linalg.norm(tag.orientation)) < 1.01:
            raise IgripError(f"tags: tags.{number}.orientation: is not a rotation")
    return read
