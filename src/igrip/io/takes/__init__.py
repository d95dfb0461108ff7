"""Takes: what a motion-capture file holds, as bodies that move in time, in igrip's frame.

``take`` holds the tracks, ``declared`` what the user declares of a file, ``clock`` repairs times,
``gaps`` finds where a body was lost, ``rotations`` turns what files hold of a rotation into
quaternions, ``build`` puts them together, ``tables``, ``c3d`` and ``files`` read takes from files,
and ``roles`` distinguishes hands from objects.
"""
