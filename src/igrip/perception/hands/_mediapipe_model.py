"""MediaPipe's hand model, put together from a package that carries its two networks.

The slim MediaPipe packages hold no models, and Google's model server is not always reachable. The
wheel of version 0.10.21 holds the same two networks, under the Apache licence 2.0; packed into one
``.task`` file they are the official model. They are fetched once, by pip from whatever index it is
set up for, and kept in igrip's cache directory: no network is needed afterwards.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from igrip.compiled import cache_directory
from igrip.errors import IgripError

DONOR = "mediapipe==0.10.21"
# which of its wheels does not matter: all hold the same networks
WHEEL = (
    "--no-deps", "--only-binary=:all:", "--python-version", "3.12", "--implementation", "cp",
    "--abi", "cp312", "--platform", "manylinux_2_28_x86_64",
)  # fmt: skip
NETWORKS = {  # name in the .task: file in the wheel, its SHA-256
    "hand_detector.tflite": (
        "mediapipe/modules/palm_detection/palm_detection_full.tflite",
        "1b14e9422c6ad006cde6581a46c8b90dd573c07ab7f3934b5589e7cea3f89a54",
    ),
    "hand_landmarks_detector.tflite": (
        "mediapipe/modules/hand_landmark/hand_landmark_full.tflite",
        "11c272b891e1a99ab034208e23937a8008388cf11ed2a9d776ed3d01d0ba00e3",
    ),
}
TIMEOUT = 600.0  # s for 36 MB


def hand_model(wheel: Path | None = None) -> Path:
    """Return the model file; make it where it is absent or has been altered.

    By default pip fetches the wheel; for a machine without an index, name it. An IgripError is
    raised if the model cannot be fetched, or is not the expected one.
    """
    path = cache_directory() / "hands" / "hand_landmarker_full.task"
    if _is_whole(path):
        return path
    with tempfile.TemporaryDirectory(prefix="igrip-hands-") as folder:
        if wheel is None:
            wheel = _download(Path(folder))
        networks = _networks(wheel)
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, draft = tempfile.mkstemp(dir=path.parent, suffix=".task")
    with os.fdopen(handle, "wb") as file, zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as task:
        for name, content in networks.items():
            task.writestr(name, content)
    os.replace(draft, path)
    return path


def _is_whole(path: Path) -> bool:
    try:
        with zipfile.ZipFile(path) as task:
            return all(
                hashlib.sha256(task.read(name)).hexdigest() == digest
                for name, (_, digest) in NETWORKS.items()
            )
    except (OSError, KeyError, zipfile.BadZipFile):
        return False


def _download(folder: Path) -> Path:
    command = [sys.executable, "-m", "pip", "download", *WHEEL, "--dest", str(folder), DONOR]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT)
        problem = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
    except (OSError, subprocess.TimeoutExpired) as error:
        problem = str(error)
    wheels = sorted(folder.glob("*.whl"))
    if not wheels:
        raise IgripError(
            f"the hand model is not in the cache and pip could not fetch {DONOR} ({problem}); "
            "connect once, or copy hands/hand_landmarker_full.task from the cache directory of "
            f"another machine into {cache_directory()}"
        )
    return wheels[0]


def _networks(wheel: Path) -> dict[str, bytes]:
    networks = {}
    try:
        with zipfile.ZipFile(wheel) as archive:
            for name, (inside, digest) in NETWORKS.items():
                content = archive.read(inside)
                if hashlib.sha256(content).hexdigest() != digest:
                    raise IgripError(f"{inside} of {wheel.name} is not the expected file (SHA-256)")
                networks[name] = content
    except (OSError, KeyError, zipfile.BadZipFile) as error:
        raise IgripError(f"{wheel}: no wheel of {DONOR}: {error}") from error
    return networks
