"""Names, dtypes, shapes and units of every observation and batch entry, and the turning sense.

An observation is one instant: a panorama of ``VIEWS`` RGB-D views and the pose of the agent.

* ``rgb``    uint8   ``[12, H, W, 3]``
* ``depth``  float32 ``[12, H, W, 1]``, metres along the optical axis; 0 means "no reading"
* ``pose``   float32 ``[3]`` = (x, y, heading): metres, metres, radians, in the plan frame

Turning sense: view ``k`` looks at yaw ``-30 k`` degrees from the heading, so a growing ``k`` turns
RIGHT (clockwise from above). ``heading`` is counter-clockwise; forward is ``(-sin h, cos h)``.
Plan frame to VLN-CE frame: ``x = x``, ``z = -y``, height ``y`` up.
"""

from __future__ import annotations

RGB = "rgb"
DEPTH = "depth"
POSE = "pose"
CLEAN_RGB = "clean_rgb"  # in training batches: the frames before the corruption
CLEAN_DEPTH = "clean_depth"
# what torchrl environments add: text, the name of this run of an episode, low-level steps taken
INSTRUCTION = "instruction"
EPISODE = "episode"
FRAME = "frame"

VIEWS = 12
VIEW_STEP_DEGREES = 30.0
HFOV_DEGREES = 90.0
Z_MAX = 10.0  # metres, the R2R-CE depth sensor range (VLN-CE config)

STOP, FORWARD, LEFT, RIGHT = 0, 1, 2, 3
FORWARD_METRES = 0.25  # VLN-CE
TURN_DEGREES = 15.0  # VLN-CE
MAX_STEPS = 500  # VLN-CE
