"""Faults: corruptions of time, camera mounting and motion, which one frame alone does not show.

Each is a pure function ``draw`` of (severity, key). A temporal fault draws the age of the frame
that arrives, a fault of the camera its displacement, a fault of motion how an action is executed.
The state is outside of the faults: ``mitigate/corruptions/stream.py`` keeps the last frames, and
``mitigate/worlds/motion.py`` the last action.
"""

from mitigate.corruptions.faults import camera, motion, temporal

RECORDS = (*temporal.RECORDS, *camera.RECORDS, *motion.RECORDS)
