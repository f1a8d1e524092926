"""Corrupt batches of torch tensors on their device, with the random numbers of the numpy suite.

``corrupt_tensors`` applies one corruption to a batch of frames. ``corrupt_observations`` applies a
different corruption to each row of a batch of RGB and depth frames. No other package in
``mitigate.corruptions`` imports torch. Functions of ``rgb`` and ``depth`` are named after the
corruptions that they compute. All other corruptions are computed on the host.
"""

from mitigate.corruptions.tensors.observations import corrupt_observations
from mitigate.corruptions.tensors.suite import BACKENDS, FUNCTIONS, corrupt_tensors

__all__ = ["BACKENDS", "FUNCTIONS", "corrupt_observations", "corrupt_tensors"]
