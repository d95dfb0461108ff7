"""Files: recordings, datasets, and the import of other laboratories' files.

``recordings`` opens a file or source by its name, with one module for each format; ``mcap`` holds
the parts of the ``.mcap`` format. ``datasets`` reads and writes folders of recordings.
``importers`` has one module for each foreign layout; ``cells``, ``layouts`` and ``tables`` read
text tables of any dialect and header, and ``takes`` makes tracks of bodies of them. ``column_map``
and the ``mapped_…`` modules read files by a map of columns, ``inspection`` shows what is understood
of files, ``resampling`` turns an imported reach into observations, and ``import_dataset`` writes
them all as a dataset.
"""
