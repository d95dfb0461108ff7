"""Tables in files, read as data frames."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from igrip.errors import DatasetError, requires_extra

if TYPE_CHECKING:
    import pandas as pd

TABLE_ENDINGS = (".parquet", ".csv", ".tsv")


def read_tables(paths: Iterable[Path]) -> dict[str, pd.DataFrame]:
    """Read tables by file stem; a folder stands for the tables in it.

    Raises
    ------
    MissingExtraError
        If pandas or pyarrow are not installed.
    DatasetError
        If a file cannot be read as a table, or two have one stem.
    """
    files: list[Path] = []
    for path in paths:
        inside = path.iterdir() if path.is_dir() else ()
        files += sorted(file for file in inside if file.suffix in TABLE_ENDINGS) or [path]
    tables: dict[str, pd.DataFrame] = {}
    for path in files:
        if path.suffix not in TABLE_ENDINGS:
            endings = ", ".join(TABLE_ENDINGS)
            raise DatasetError(f"{path}: expected a file {endings} or a folder of them")
        if path.stem in tables:
            raise DatasetError(f"{path}: two tables are named {path.stem!r}")
        try:
            tables[path.stem] = _read_table(path)
        except (OSError, ValueError) as error:
            raise DatasetError(f"{path}: cannot be read as a table: {error}") from error
    return tables


def _read_table(path: Path) -> Any:
    with requires_extra("pandas", "tables", "importing tables"):
        import pandas as pd
    if path.suffix == ".parquet":
        with requires_extra("pyarrow", "tables", "importing tables"):
            import pyarrow  # noqa: F401 - pandas needs it
        return pd.read_parquet(path)
    return pd.read_csv(path, sep="\t" if path.suffix == ".tsv" else ",")
