"""Pictures of objects for the participant's screen, drawn from their meshes."""

from __future__ import annotations

import io
import math

import numpy as np

from igrip.errors import requires_extra
from igrip.lab.rendering.layout import PlacedMesh
from igrip.lab.rendering.scene import RenderedScene
from igrip.objects.model import ObjectModel
from igrip.rgbd import Intrinsics

SIZE = 512  # pixels
TILT = math.radians(15.0)  # it is seen a little from above
LIFT = 2.0  # m over the scene's table, so that nothing hides it
FILL = 0.8  # of the picture that the object's sphere covers


def object_picture(model: ObjectModel, colour: str) -> bytes:
    """Return a picture of an upright object in one colour, as PNG with a clear background.

    Parameters
    ----------
    model : ObjectModel
        With its upright axis along z.
    colour : str
        ``#rrggbb``.
    """
    with requires_extra("matplotlib", "report", "pictures of objects"):
        from matplotlib.image import imsave

    sphere = model.sphere
    distance = 6.0 * float(sphere[3])
    focal = 0.5 * FILL * SIZE * distance / float(sphere[3])
    intrinsics = Intrinsics(SIZE, SIZE, focal, focal, 0.5 * SIZE, 0.5 * SIZE)
    ahead = np.array([0.0, math.cos(TILT), -math.sin(TILT)])
    right = np.array([1.0, 0.0, 0.0])
    lifted, camera = np.eye(4), np.eye(4)
    lifted[2, 3] = LIFT
    camera[:3, :3] = np.column_stack([right, np.cross(ahead, right), ahead])
    camera[:3, 3] = lifted[:3, 3] + sphere[:3] - distance * ahead
    scene = RenderedScene({model.name: PlacedMesh(model, lifted)}, camera, intrinsics)
    _, labels = scene.truth()
    _, _, cosine = scene.picture()
    seen = labels == 0
    rgb = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    picture = np.zeros((SIZE, SIZE, 4))
    picture[..., :3] = rgb * (0.45 + 0.55 * cosine)[..., None]
    picture[..., 3] = seen
    file = io.BytesIO()
    imsave(file, np.clip(np.nan_to_num(picture), 0.0, 1.0), format="png")
    return file.getvalue()
