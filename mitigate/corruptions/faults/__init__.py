"""Faults are corruptions of timing, camera mounting and motion, which a single frame does not show.

Each fault is a pure function ``draw(severity, key)``. A temporal fault samples the age of the frame
that arrives. A camera fault samples the displacement of the camera. A motion fault samples how an
action is executed. Faults keep no state: ``mitigate/corruptions/stream.py`` keeps the last frames,
and ``mitigate/worlds/motion.py`` the last action.
"""

from mitigate.corruptions.faults import camera, motion, temporal

RECORDS = (*temporal.RECORDS, *camera.RECORDS, *motion.RECORDS)
