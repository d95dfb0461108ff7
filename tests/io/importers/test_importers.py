"""Importers are found by the files they recognise."""

from __future__ import annotations

from pathlib import Path

import pytest

from igrip.errors import DatasetError
from igrip.io.importers import IMPORTERS, ImportFiles, find_importer

pytest.importorskip("pandas", reason="the extra 'tables' is not installed")


def test_unknown_tables_are_refused_with_what_was_found(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("a,b\n1,2\n")
    with pytest.raises(DatasetError, match=r"no importer recognises.*t: a, b"):
        find_importer(ImportFiles([tmp_path]))


def test_unknown_files_are_refused_with_what_was_found(tmp_path: Path) -> None:
    (tmp_path / "t.xlsx").write_bytes(b"")
    with pytest.raises(DatasetError, match=r"no importer recognises.*Found .*t\.xlsx"):
        find_importer(ImportFiles([tmp_path / "t.xlsx"]))
    with pytest.raises(DatasetError, match="nothing: no such file or folder"):
        ImportFiles([tmp_path / "nothing"])


class ReadsItsOwnWay:
    """An importer of files that are no plain tables, as motion-capture systems export them."""

    name, license, source = "own", "unknown", "unknown"

    def recognises(self, files: ImportFiles) -> bool:
        return any(path.read_bytes().startswith(b"Format Version") for path in files.paths)

    def reaches(self, files: ImportFiles) -> list:
        return []


def test_an_importer_may_read_files_that_are_no_tables(tmp_path, monkeypatch) -> None:
    path = tmp_path / "motion.parquet"
    path.write_bytes(b"Format Version,1.23\n")
    with pytest.raises(DatasetError, match="cannot be read as a table"):
        find_importer(ImportFiles([path]))
    own = ReadsItsOwnWay()
    monkeypatch.setitem(IMPORTERS._members, "zz_own", own)  # after those that fail to read it
    assert find_importer(ImportFiles([path])) is own
