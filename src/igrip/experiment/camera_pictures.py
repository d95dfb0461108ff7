"""What a camera sees now, with what was detected drawn in, for the experimenter's page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from igrip.entities import Hand, ObjectPose
from igrip.errors import requires_extra
from igrip.objects.catalog import Catalog
from igrip.rgbd import RgbdFrame

Seen = Hand | ObjectPose

WIDTH = 640  # pixels at most
QUALITY = 70  # of the JPEG
HAND, OBJECT = (20, 120, 220), (40, 160, 60)  # colours, blue, green, red
MIN_DEPTH = 0.05  # m; what is nearer to the camera is not drawn


def camera_picture(
    frame: RgbdFrame, seen: Mapping[str, Seen], catalog: Catalog | None = None
) -> bytes:
    """Return a frame as JPEG, with a circle and a name at every hand and object that is seen.

    Parameters
    ----------
    frame : RgbdFrame
        What the camera sees.
    seen : mapping of str to Hand or ObjectPose
        By their ids.
    catalog : Catalog, optional
        With the models: the circle is then at the middle of the object, not at the mesh's origin.
    """
    with requires_extra("opencv-python-headless", "mcap", "pictures of cameras"):
        import cv2
    height, width = frame.colour.shape[:2]
    size = (min(width, WIDTH), max(1, round(height * min(width, WIDTH) / width)))
    picture = cv2.cvtColor(cv2.resize(frame.colour, size), cv2.COLOR_RGB2BGR)
    intrinsics = frame.intrinsics.scaled(*size)
    camera_from_world = np.linalg.inv(frame.world_from_camera)
    for id, one in seen.items():
        name, colour = (f"{id} hand", HAND) if isinstance(one, Hand) else (id, OBJECT)
        position = _middle(one, catalog)
        point = (camera_from_world @ [*position, 1.0])[:3]
        if point[2] < MIN_DEPTH:
            continue
        u, v = intrinsics.pixels(point[None])[0]
        if 0 <= u < size[0] and 0 <= v < size[1]:
            at = (round(u), round(v))
            cv2.circle(picture, at, 9, colour, 3, cv2.LINE_AA)
            font = (cv2.FONT_HERSHEY_SIMPLEX, 0.55)
            (wide, high), below = cv2.getTextSize(name, *font, 1)
            x, y = max(2, min(at[0] + 14, size[0] - wide - 4)), at[1] + high // 2
            box = ((x - 2, y - high - 3), (x + wide + 2, y + below))
            cv2.rectangle(picture, *box, (255, 255, 255), cv2.FILLED)
            cv2.putText(picture, name, (x, y), *font, (0, 0, 0), 1, cv2.LINE_AA)
    _, data = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    return bytes(data)


def _middle(one: Seen, catalog: Catalog | None) -> Sequence[float]:
    if isinstance(one, Hand) or catalog is None or one.model is None or one.model not in catalog:
        return one.position
    turned = Rotation.from_quat(one.orientation).apply(catalog[one.model].sphere[:3])
    return tuple(one.position + turned)
