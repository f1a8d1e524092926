"""Corrupt batches of torch tensors on their device, with the random numbers of the numpy suite.

``corrupt_tensors`` applies one corruption to a batch, and ``corrupt_observations`` applies a
corruption per row to RGB and depth. Only this package of ``mitigate.corruptions`` imports torch.

Each function of ``rgb``, ``depth``, ``unseen_rgb`` and ``unseen_depth`` has the name of a
corruption and computes a batch on its device. Other corruptions are computed on the host.
"""

from mitigate.corruptions.tensors.observations import corrupt_observations
from mitigate.corruptions.tensors.suite import BACKENDS, FUNCTIONS, corrupt_tensors

__all__ = ["BACKENDS", "FUNCTIONS", "corrupt_observations", "corrupt_tensors"]
