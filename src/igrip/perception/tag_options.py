"""Options of detectors that look for AprilTags, and the TOML file that may hold them."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from igrip.entities import Quaternion, Vector
from igrip.errors import IgripError
from igrip.io.text import TextError, read_text
from igrip.perception.options import validated
from igrip.settings import Settings, quantity


class PlacedTag(Settings):
    """A tag on something rigid.

    Attributes
    ----------
    position, orientation : 3 and 4 floats
        Pose of the tag in the frame of what it is stuck to [m], quaternion x, y, z, w. The tag's
        frame: centre, x to the right, y up, z out of it.
    """

    size: float = quantity(..., "m", "edge of the tag's black square", gt=0.0, le=1.0)
    position: Vector = (0.0, 0.0, 0.0)
    orientation: Quaternion = (0.0, 0.0, 0.0, 1.0)


class TagSearch(Settings):
    """Which tags are looked for, and how.

    Attributes
    ----------
    tags : mapping of int to PlacedTag
        By number; in a TOML file: tables ``[tags.7]``.
    family : str
        Of all tags.
    """

    tags: Mapping[int, PlacedTag]
    family: str = "tag36h11"
    decimate: float = quantity(2.0, "1", "tags are looked for in a smaller picture", "docs/tags.md")
    max_pose_age: float = quantity(
        0.3, "s", "of a pose that may decide between two new ones", "guess", ge=0
    )


S = TypeVar("S", bound=TagSearch)


def read_tag_options(kind: type[S], name: str, options: Mapping[str, Any], missing: str) -> S:
    """Read options, and the TOML file that ``tags`` may name.

    Parameters
    ----------
    kind : type
        Of the options.
    name : str
        With which messages begin.
    options : mapping
        As given.
    missing : str
        What to say where no tag is given.

    Raises
    ------
    IgripError
        If they cannot be read or a tag is placed by no rotation.
    """
    given = dict(options)
    if isinstance(given.get("tags"), str | Path):
        path = Path(given.pop("tags"))
        try:
            given = tomllib.loads(read_text(path)) | given
        except (OSError, TextError, tomllib.TOMLDecodeError) as error:
            raise IgripError(f"{path}: cannot be read: {error}") from error
    if not given.get("tags"):
        raise IgripError(f"{name}: {missing}")
    read = validated(kind, name, given)
    for number, tag in read.tags.items():
        if not 0.99 < float(np.linalg.norm(tag.orientation)) < 1.01:
            raise IgripError(f"{name}: tags.{number}.orientation: is not a rotation")
    return read
