"""Takes from tables: the bodies that the columns name."""

from __future__ import annotations

from igrip.errors import DatasetError
from igrip.io.column_names import shortened
from igrip.io.tables import Table
from igrip.io.takes.declared import Declared
from igrip.io.takes.sections import table_take, with_sections
from igrip.io.takes.take import Take


def take_of(name: str, table: Table, declared: Declared) -> Take:
    """Return what a table with named bodies holds, with the further sections of its file.

    Raises
    ------
    DatasetError
        If it has no times or no bodies; the message says what to declare.
    """
    if not table.layout.bodies:
        raise DatasetError(
            f"{table.path}: no columns of x, y and z were found; it has {shortened(table.columns)}"
            '; if some are a position, a map names them: t = "…", x = "…", y = "…", z = "…"'
        )
    return with_sections(table_take(name, table, declared), table, declared)
