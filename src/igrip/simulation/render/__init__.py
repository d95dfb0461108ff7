"""A rendered RGB-D camera: meshes on a table, ray by ray, with the noise of a stereo camera."""
