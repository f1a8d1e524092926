# %% [markdown]
# # Replay a ROS bag with your own policy
#
# This tutorial writes a ROS bag and shows its frames to a policy, once clean and once corrupted. It
# measures how many decisions change. The tutorial takes about 30 seconds on a CPU and needs no ROS.
# The bag is simulated: it contains the drives of an oracle through a generated apartment.
# Replace it with a bag of your robot.

# %%
import subprocess

subprocess.run(
    ["mitigate", "export_drive", "runs/drives", "episodes=1", "form=bag"],
    check=True,
    stdout=subprocess.DEVNULL,
)

# %% [markdown]
# ## The policy
#
# The policy turns left while something in front of the robot is closer than 0.6 metres, and drives
# forward otherwise. `sensors` lists the sensors that the policy reads. `depth` is float32 [64, 64,
# 1] in metres, where 0 means that nothing was measured.

# %%
import numpy as np

from mitigate.core.observation import FORWARD, LEFT


class AvoidObstacles:
    sensors = ("depth",)

    def reset(self, instruction):
        pass  # the policy ignores the instruction

    def act(self, observation):
        depth = observation["depth"]
        middle = depth[depth.shape[0] // 3 : 2 * depth.shape[0] // 3]
        return LEFT if np.percentile(middle, 20) < 0.6 else FORWARD


# %% [markdown]
# ## The recording
#
# Check first what will be read. `open_recording` reads the structure of a bag. `load` reads its
# frames as square views of 64 pixels, one frame per 0.25 metres or 15 degrees of motion. `views=1`
# selects a single camera.
#
# The summary shows the topics, the field of view and its border, the unit and range of depth, and
# whether there are poses. If several topics fit, choose one:
# `open_recording(bag, topics={"rgb": "/front/image_raw"})`. Other options are `instruction=`,
# `unit=` (metres per count of depth), `hfov=` and `yaw=`.

# %%
from pathlib import Path

from mitigate.worlds.recorded import Step, load, open_recording

bag = next(Path("runs/drives").glob("*.bag"))
(source,) = open_recording(bag)
recording = load(source, views=1, size=64, step=Step())
print("\n".join(recording.summary))

# %% [markdown]
# ## The report
#
# The robot drives as recorded, whatever the policy answers. At each step, the question is what the
# policy would do now. `replay_recordings` prints a table with intervals, and writes the table,
# pictures and all decisions into a folder.

# %%
import mitigate

report = mitigate.replay_recordings(
    AvoidObstacles(),
    bag,
    conditions=["gaussian_noise", "missing_data", "quantization"],
    severity=0.6,
    out="runs/avoid_obstacles",
)
print(sorted(path.name for path in report.iterdir()))

# %% [markdown]
# The command `mitigate replay` does the same. It accepts a policy in a file and folders of weights.
# For the first line, save the class above and its imports as `my_policy.py` in the current folder:
#
# ```bash
# mitigate replay runs/drives "agents=[my_policy:AvoidObstacles]" suite=depth out=runs/replay/mine
# mitigate replay runs/drives "agents=[checkpoints/recurrent/base,checkpoints/recurrent/teacher]"
# ```
#
# ## Decisions one by one
#
# For your own analysis, `walk` returns the decisions for one drive under one corruption.

# %%
from mitigate.corruptions import CLEAN, Corruption
from mitigate.replay.walk import walk

policy = AvoidObstacles()
clean = walk(policy, recording, CLEAN, seed=0)
corrupted = walk(policy, recording, Corruption("missing_data", 0.6), seed=0, clean=clean)
print("changed steps:", np.flatnonzero(clean.actions != corrupted.actions))

# %% [markdown]
# The percentages in the table are shares of changed decisions, not of failures. In `missing_data`,
# most holes are 0 m: the policy reads them as obstacles and turns left where it drove forward on
# clean frames.
