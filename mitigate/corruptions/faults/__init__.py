"""Faults are corruptions of timing, camera mounting and motion, which a single frame does not show.

Most faults have a pure function ``draw(severity, key)``, which describes one time step. For a
temporal fault, it returns the age, in frames, of the frame that the agent receives. For a camera
fault, it returns the displacement of the camera. For a motion fault, it returns how the action is
executed. Faults keep no state: ``mitigate/corruptions/stream.py`` keeps the last frames, and
``mitigate/worlds/motion.py`` keeps the last action.
"""

from mitigate.corruptions.faults import camera, motion, temporal

RECORDS = (*temporal.RECORDS, *camera.RECORDS, *motion.RECORDS)
