"""Files: recordings, datasets, and the import of other laboratories' files.

``recordings`` opens a file or source by its name, with one module for each format; ``mcap`` holds
the parts of the ``.mcap`` format. ``datasets`` reads and writes folders of recordings.
``importers`` has one module for each foreign layout; ``column_map`` reads tables of any other
layout, ``resampling`` turns an imported reach into observations, and ``import_dataset`` writes them
all as a dataset.
"""
