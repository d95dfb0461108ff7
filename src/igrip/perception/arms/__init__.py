"""Arms in depth pictures: what comes in over the table, whatever it wears, and where it ends."""
