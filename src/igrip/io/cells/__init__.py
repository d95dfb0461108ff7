"""The cells of a text table: its lines, its separator and decimal mark, and single values."""
