"""Datasets at an address of shared storage, such as ``s3://bucket/cohort``, read by fsspec.

Tables and meshes are fetched when a dataset is opened, each recording when it is read, into the
cache of the computer that reads it.
"""

from __future__ import annotations

import hashlib
import os
import re
import tempfile
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from igrip.compiled import cache_directory
from igrip.errors import DatasetError, RecordingError, StorageError, requires_extra
from igrip.io.datasets.dataset import Dataset, Trial

ADDRESS = re.compile(r"([a-z][a-z0-9+.-]+):/(.*)", re.IGNORECASE)  # C:/ is a drive
LOCAL = ("file", "local")  # protocols of paths without a host
PLAIN = re.compile(r"\w[\w -]*")  # the name of a folder within the dataset
TABLES = ("dataset.json", "trials.tsv", "participants.tsv")


def address_of(path: str | Path) -> str | None:
    """Return the address that a path is meant to be; None for a folder of this computer.

    A Path makes ``s3:/bucket`` of ``s3://bucket`` and ``file:/lab`` of ``file:///lab``; that is
    undone.
    """
    found = ADDRESS.fullmatch(str(path))
    if found is None:
        return None
    protocol, rest = found[1], found[2].strip("/")
    return f"{protocol}:///{rest}" if protocol in LOCAL else f"{protocol}://{rest}"


def open_dataset(path: str | Path, lenient: bool = False) -> Dataset:
    """Open a dataset in a folder or at an address; as :meth:`Dataset.open`.

    Raises
    ------
    MissingExtraError
        If the address needs a package that is not installed.
    DatasetError
        If there is no dataset.
    """
    address = address_of(path)
    if address is None:
        return Dataset.open(path, lenient)
    storage = SharedFolder(address)
    there = {name: storage.fetch(name) for name in TABLES}
    if there["dataset.json"] is None:
        raise DatasetError(f"{address}: is not a dataset: it has no dataset.json")
    opened = Dataset.open(storage.local, lenient)
    for source in opened.description.get("objects", ()):
        if PLAIN.fullmatch(str(source)):
            for name in storage.files(str(source)):
                storage.fetch(name)
    return SharedDataset(opened.path, opened.description, opened.trials, storage)


@dataclass(frozen=True)
class SharedFolder:
    """A folder at an address, and its copy on this computer.

    Attributes
    ----------
    address : str
        As fsspec takes it.
    """

    address: str

    def __getstate__(self) -> dict[str, Any]:
        return {"address": self.address}  # another computer opens its own connection

    @property
    def local(self) -> Path:
        """Where the copy is."""
        name = hashlib.sha256(self.address.encode()).hexdigest()[:16]
        return cache_directory() / "datasets" / name

    @cached_property
    def _storage(self) -> tuple[Any, str]:
        with requires_extra("fsspec", "cluster", "datasets at addresses"):
            import fsspec
        try:
            system, root = fsspec.core.url_to_fs(self.address)
        except (ValueError, ImportError) as error:
            raise DatasetError(f"{self.address}: {error}") from error
        return system, root.rstrip("/")

    def stamp(self, name: str) -> str | None:
        """Return what changes when a file does; None where there is none."""
        system, root = self._storage
        try:
            about = system.info(f"{root}/{name}")
        except FileNotFoundError:
            return None
        except Exception as error:  # each protocol has errors of its own
            raise StorageError(f"{self.address}/{name}: {error!r:.200}") from error
        changed = next((about[k] for k in ("ETag", "mtime", "created", "LastModified",
                                           "last_modified") if k in about), "")  # fmt: skip
        return f"{about.get('size')}-{changed}"

    def files(self, folder: str) -> list[str]:
        """Return the files in a folder of this one, by name; none where there is no folder."""
        system, root = self._storage
        try:
            found = system.find(f"{root}/{folder}")
        except FileNotFoundError:
            return []
        except Exception as error:
            raise StorageError(f"{self.address}/{folder}: {error!r:.200}") from error
        return sorted(path[path.index(f"{root}/") + len(root) + 1 :] for path in found)

    def fetch(self, name: str) -> Path | None:
        """Return the copy of a file, fetched if it is not there or has changed; None: no file.

        Raises
        ------
        StorageError
            If it cannot be fetched.
        """
        if ".." in Path(name).parts:
            raise DatasetError(f"{self.address}: {name!r} leads out of the folder")
        stamp, path = self.stamp(name), self.local / name
        if stamp is None:
            path.unlink(missing_ok=True)  # it was there once
            return None
        note = path.with_name(f".{path.name}.stamp")
        if path.is_file() and note.is_file() and note.read_text(encoding="utf-8") == stamp:
            return path
        path.parent.mkdir(parents=True, exist_ok=True)
        system, root = self._storage
        handle, new = tempfile.mkstemp(dir=path.parent)
        os.close(handle)
        try:
            system.get_file(f"{root}/{name}", new)
            os.replace(new, path)  # other processes may fetch it, too
        except Exception as error:
            raise StorageError(f"{self.address}/{name}: {error!r:.200}") from error
        finally:
            Path(new).unlink(missing_ok=True)
        note.write_text(stamp, encoding="utf-8")
        return path


@dataclass(frozen=True)
class SharedDataset(Dataset):
    """A dataset at an address; its ``path`` is that of the copy.

    Attributes
    ----------
    storage : SharedFolder
        Where it comes from.
    """

    storage: SharedFolder

    def recording(self, trial: Trial) -> Path:
        """Return the copy of a trial's recording, fetched now.

        Raises
        ------
        RecordingError
            If there is none.
        """
        name = self._name_of(trial)
        path = None if name is None else self.storage.fetch(name)
        if path is None:
            raise RecordingError(f"{self.storage.address}/recordings: no {trial.recording!r}")
        return path

    def stamp(self, trial: Trial) -> str | None:
        """Return what changes when a recording does, without fetching it."""
        name = self._name_of(trial)
        return None if name is None else self.storage.stamp(name)

    def _name_of(self, trial: Trial) -> str | None:
        return self._names.get(trial.recording) or self._names.get(trial.recording.lower())

    @cached_property
    def _names(self) -> dict[str, str]:
        """Files of recordings by their name without folder and ending."""
        files = self.storage.files("recordings")
        by_name = {name.partition("/")[2].rpartition(".")[0]: name for name in files}
        return by_name | {name.partition("/")[2]: name for name in files}
