"""Opens the cameras of a study with their detectors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from igrip.experiment.cameras import CameraRecorder, TappedCamera
from igrip.experiment.study import Study, StudyError
from igrip.objects.catalog import Catalog
from igrip.perception.cameras import open_camera
from igrip.perception.pipeline.pipeline import Pipeline
from igrip.perception.pipeline.stages import hand_stages, object_stages, warm_up_stages


def parse_cameras(study: Study, given: Sequence[str]) -> dict[str, str]:
    """Return the address of each camera of a study from ``NAME=ADDRESS``.

    Raises
    ------
    StudyError
        If one has another form or no such name, or one is missing.
    """
    addresses: dict[str, str] = {}
    for text in given:
        name, equals, address = text.partition("=")
        if not equals or not address or name not in study.cameras:
            raise StudyError(
                f"--camera {text!r:.60}: give NAME=ADDRESS, such as {study.cameras[0]}=oak; the "
                f"study's cameras are {', '.join(study.cameras)}"
            )
        addresses[name] = address
    missing = [name for name in study.cameras if name not in addresses]
    if missing:
        raise StudyError(
            f"the study's camera {missing[0]} has no address: --camera {missing[0]}=oak; or try "
            "without cameras: --simulate"
        )
    return addresses


def open_recorder(
    study: Study, addresses: Mapping[str, str], catalog: Catalog, hands: str, poses: str,
    calibration: Path | None = None,
) -> CameraRecorder:  # fmt: skip
    """Open all cameras and begin to detect hands and objects in each.

    Parameters
    ----------
    study : Study
        With cameras and objects.
    addresses : mapping of str to str
        As of :func:`igrip.perception.cameras.open_camera`, by camera.
    catalog : Catalog
        With the study's models.
    hands, poses : str
        Names of the detector of hands and the estimator of poses, as of ``igrip live``.
    calibration : Path, optional
        Where the cameras stand, of ``igrip calibrate``.

    Raises
    ------
    IgripError
        If a camera, a detector or a package is missing.
    """
    models = [one.model for one in study.objects.values()]
    new_hands = hand_stages(hands, 2, False, 1)
    new_objects = object_stages(poses, catalog, {"models": models})
    warm_up_stages(new_hands, new_objects, catalog, models)
    taps: dict[str, TappedCamera] = {}
    try:
        for name, address in addresses.items():
            taps[name] = TappedCamera(open_camera(address, calibration))
    except BaseException:
        for tap in taps.values():
            tap.close()
        raise
    pipelines = {
        name: Pipeline(tap, hand_stages(hands, 2, False, 1), new_objects)
        for name, tap in taps.items()
    }
    return CameraRecorder(study, pipelines, taps, catalog=catalog)
