"""Adam (Kingma & Ba 2015, ICLR) on a decimal grid, with a learning rate that falls as a cosine.

The weights are rounded at every step. Differences in the last digits between machines (other
instructions, other orders of summation) are rounded away before they can grow, so that a second
training gives the same file (docs/decisions/0007).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
DIGITS = 6  # of the grid
RATE, DECAY = 4e-3, 1e-4
BETA_1, BETA_2 = 0.9, 0.999  # decay of the averages of the gradient and of its square


class Adam:
    """One minimisation.

    Parameters
    ----------
    weights : sequence of arrays
        Where to begin; copied.
    steps : int
        How many steps there will be.

    Attributes
    ----------
    weights : list of arrays
        As they are now.
    """

    def __init__(self, weights: Sequence[Array], steps: int) -> None:
        self.weights = [np.round(w, DIGITS) for w in weights]
        self._averages = [(np.zeros_like(w), np.zeros_like(w)) for w in self.weights]
        self._step, self._steps = 0, steps

    def step(self, gradients: Sequence[Array]) -> None:
        """Move the weights against their gradients."""
        self._step += 1
        rate = RATE * 0.5 * (1.0 + np.cos(np.pi * self._step / self._steps))
        for k, gradient in enumerate(gradients):
            one, two = self._averages[k]
            gradient = gradient + DECAY * self.weights[k]
            one += (1.0 - BETA_1) * (gradient - one)
            two += (1.0 - BETA_2) * (gradient**2 - two)
            slope = one / (1.0 - BETA_1**self._step)
            size = np.sqrt(two / (1.0 - BETA_2**self._step)) + 1e-8
            self.weights[k] = np.round(self.weights[k] - rate * slope / size, DIGITS)
