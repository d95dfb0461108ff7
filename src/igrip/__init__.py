"""igrip: from where the hands are and where things are, to what each hand will grasp, and how."""

from igrip.config import Config
from igrip.entities import Hand, ObjectPose
from igrip.errors import IgripError, ObservationError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.objects.catalog import Catalog, load_objects
from igrip.observation import Observation
from igrip.sources.base import open_source
from igrip.version import __version__

__all__ = [
    "Catalog",
    "Config",
    "Estimator",
    "Hand",
    "IgripError",
    "Intention",
    "ObjectPose",
    "Observation",
    "ObservationError",
    "__version__",
    "load_objects",
    "open_source",
]
