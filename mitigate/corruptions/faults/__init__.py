"""Faults: corruptions of time, camera mounting and motion, which one frame alone does not show.

Each is a pure function ``draw`` of (severity, key). A temporal fault draws the age of the frame
that arrives. The state is outside of the faults: ``mitigate/corruptions/stream.py`` keeps the last
frames.
"""

from mitigate.corruptions.faults import temporal

RECORDS = (*temporal.RECORDS,)
