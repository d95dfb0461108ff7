"""Cameras: each yields :class:`igrip.rgbd.RgbdFrame`; found by the form of a name."""
