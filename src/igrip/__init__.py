"""igrip: predicts which object each moving hand will grasp, with which grip, and when."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from igrip.version import __version__

if TYPE_CHECKING:
    from igrip.config import Config
    from igrip.entities import Hand, ObjectPose
    from igrip.errors import IgripError, ObservationError
    from igrip.estimator import Estimator
    from igrip.intention import Intention
    from igrip.io.intentions import Intentions, read_intentions
    from igrip.io.recordings import open_source
    from igrip.lab.report.probability_figure import plot_probability
    from igrip.objects.catalog import Catalog, load_objects
    from igrip.observation import Observation

# imported when first used: meshes, kernels and settings take most of a second to load
_HOMES = {
    "Catalog": "igrip.objects.catalog",
    "Config": "igrip.config",
    "Estimator": "igrip.estimator",
    "Hand": "igrip.entities",
    "IgripError": "igrip.errors",
    "Intention": "igrip.intention",
    "Intentions": "igrip.io.intentions",
    "ObjectPose": "igrip.entities",
    "Observation": "igrip.observation",
    "ObservationError": "igrip.errors",
    "load_objects": "igrip.objects.catalog",
    "open_source": "igrip.io.recordings",
    "plot_probability": "igrip.lab.report.probability_figure",
    "read_intentions": "igrip.io.intentions",
}

__all__ = [
    "Catalog",
    "Config",
    "Estimator",
    "Hand",
    "IgripError",
    "Intention",
    "Intentions",
    "ObjectPose",
    "Observation",
    "ObservationError",
    "__version__",
    "load_objects",
    "open_source",
    "plot_probability",
    "read_intentions",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'igrip' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
