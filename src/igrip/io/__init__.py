"""Files and tables: recordings, datasets, importers; nothing here estimates anything."""
