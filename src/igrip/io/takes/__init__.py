"""Takes: what a motion-capture file holds, as bodies that move in time, in igrip's frame.

``take`` holds the tracks, ``clock`` repairs times, ``gaps`` finds where a body was lost,
``rotations`` turns what files hold of a rotation into quaternions, ``build`` puts them together, and
``files`` reads takes from tables and from C3D.
"""
