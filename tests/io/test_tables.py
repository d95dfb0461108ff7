"""Tables are read by their stem."""

from pathlib import Path

import pytest

from igrip.errors import DatasetError
from igrip.io.table_files import read_tables

pytest.importorskip("pandas", reason="the extra 'tables' is not installed")


def test_a_file_that_is_no_table(tmp_path: Path) -> None:
    (tmp_path / "t.parquet").write_text("not parquet")
    with pytest.raises(DatasetError, match=r"t\.parquet: cannot be read as a table"):
        read_tables([tmp_path / "t.parquet"])
    with pytest.raises(DatasetError, match="expected a file"):
        read_tables([tmp_path / "t.xlsx"])
