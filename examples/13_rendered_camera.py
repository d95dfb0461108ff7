"""A rendered camera: the picture in which hands and objects are detected, without a camera."""

import sys

import matplotlib.pyplot as plt

from igrip.perception.cameras.rendered import RenderedCamera

camera = RenderedCamera(seed=0)
frame = camera.frame(t=1.0)
figure, (colour, depth) = plt.subplots(1, 2, figsize=(8, 3), layout="constrained")
colour.imshow(frame.colour)
colour.set(title="colour", xticks=[], yticks=[])
shown = depth.imshow(frame.depth, cmap="viridis", vmin=0.4, vmax=1.2)
depth.set(title="depth", xticks=[], yticks=[])
figure.colorbar(shown, ax=depth, label="m")
figure.savefig(sys.argv[1]) if len(sys.argv) > 1 else plt.show()
print(f"{frame.colour.shape[1]} × {frame.colour.shape[0]} pixels")
camera.close()
