"""Corruptions that no recipe trains on: what an agent keeps where its list ends.

They differ in mechanism from the twelve of the suite, and no schedule draws one that it does not
name. Each modality has two halves: methods may be chosen by what they keep on the validation half,
and are reported on the test half. Each file is a family of mechanisms, with corruptions in both.
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
