# %% [markdown]
# # Replay a ROS bag with your own policy
#
# This tutorial writes a ROS bag, shows its frames to a policy, clean and corrupted, and measures how many decisions
# change. It takes about 30 seconds on a CPU. The bag is simulated: it records an oracle in a generated apartment.
# Use the bag of your robot in its place. ROS is not needed.

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
# It turns left while something is closer than 0.6 metres in front of it, and drives forward otherwise.
# `sensors` lists what it reads. `depth` is float32 [64, 64, 1] in metres, with 0 where nothing was measured.

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
# Check first what will be read. `open_recording` reads the structure of a bag, `load` its frames: square views of 64
# pixels, one per 0.25 metres or 15 degrees of motion. `views=1` is a single camera.
#
# The summary names the topics, the field of view and its border, the unit and range of depth, and whether there are
# poses. If several topics fit, choose: `open_recording(bag, topics={"rgb": "/front/image_raw"})`. Other options are
# `instruction=`, `unit=` (metres per count of depth), `hfov=` and `yaw=`.

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
# The robot drives as recorded, whatever the policy answers. Each decision asks: what would it do now?
# `replay_recordings` prints a table with intervals, and writes it with pictures and all decisions into a folder.

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
# The command does the same with a policy in a file, here `my_policy.py` in the current folder, and with weights in
# folders:
#
# ```bash
# mitigate replay runs/drives agents=[my_policy:AvoidObstacles] suite=depth
# mitigate replay runs/drives agents=[checkpoints/recurrent/base,checkpoints/recurrent/teacher]
# ```
#
# ## Decisions one by one
#
# `walk` returns the decisions on one drive under one corruption, for your own analysis.

# %%
from mitigate.corruptions import CLEAN, Corruption
from mitigate.replay.walk import walk

policy = AvoidObstacles()
clean = walk(policy, recording, CLEAN, seed=0)
corrupted = walk(policy, recording, Corruption("missing_data", 0.6), seed=0, clean=clean)
print("changed steps:", np.flatnonzero(clean.actions != corrupted.actions))
