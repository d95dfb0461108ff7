"""The report of an evaluation: figures, tables, page."""
