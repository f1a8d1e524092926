"""Unseen corruptions: corruptions that no recipe trains on.

They measure whether robustness transfers. Their mechanisms differ from the standard suite, and a
schedule draws one only if it names it. Each modality has two halves: methods may be chosen on
the validation half and are reported on the test half. Each file holds a family of mechanisms, with
corruptions in both halves.
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
