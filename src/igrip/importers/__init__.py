"""Tables of other laboratories turned into datasets; one file a layout."""

from igrip.importers.base import IMPORTERS, Importer, ImportOptions, Reach

__all__ = ["IMPORTERS", "ImportOptions", "Importer", "Reach"]
