"""Broad augmentation: random compositions of primitive transforms, for training alone.

A schedule with ``broad_share`` draws them beside the named corruptions, so that what an agent
learns is not the list. They are never part of a suite. The primitives are those of PRIME (Modas et
al., ECCV 2022: tone, filter, warp) and of AugMix's kin, and what sensors share: noise, covers, lost
parts.
"""

from mitigate.corruptions.broad import depth, rgb

RECORDS = (rgb.RECORD, depth.RECORD)
