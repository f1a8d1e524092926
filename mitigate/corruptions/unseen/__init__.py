"""Unseen corruptions, which no recipe uses for training.

They measure whether robustness transfers to new failures. Their mechanisms differ from the standard
suite, and a schedule uses an unseen corruption only if it is named explicitly. Each modality has
two halves: methods may be chosen on the validation half and are reported on the test half. Each
file contains one family of mechanisms, with corruptions in both halves.
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
