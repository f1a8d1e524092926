"""Corrupt batches of torch tensors on their device, with the random numbers of the numpy suite.

``corrupt_tensors`` applies one corruption to a batch of frames. ``corrupt_observations`` applies a
different corruption to each row of a batch of RGB and depth frames. No other package in
``mitigate.corruptions`` imports torch.

The functions in ``rgb`` and ``depth`` compute corruptions on the device. Each is named after its
corruption. All other corruptions are computed on the host.
"""

from mitigate.corruptions.tensors.observations import corrupt_observations
from mitigate.corruptions.tensors.suite import BACKENDS, FUNCTIONS, corrupt_tensors

__all__ = ["BACKENDS", "FUNCTIONS", "corrupt_observations", "corrupt_tensors"]
