"""Unseen corruptions, which no recipe uses for training.

They measure whether robustness transfers to new failures. Their mechanisms differ from the
mechanisms of the standard suite, and a schedule uses an unseen corruption only if it is named
explicitly. For each modality, they are divided into a validation set and a test set. Methods may be
chosen on the validation set; results are reported on the test set. Each file contains one family of
mechanisms, with corruptions of both sets.
"""

from mitigate.corruptions.unseen import calibration, codec, edges, light, optics, returns, signal

RECORDS = (
    *light.RECORDS,
    *optics.RECORDS,
    *signal.RECORDS,
    *codec.RECORDS,
    *calibration.RECORDS,
    *edges.RECORDS,
    *returns.RECORDS,
)
