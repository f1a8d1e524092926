# %% [markdown]
# # Replay a ROS bag with your own policy
#
# This tutorial writes a ROS bag, shows its frames to a policy, clean and corrupted, and counts how many decisions
# change. It takes about 20 seconds on a CPU. The bag is simulated: it records an oracle in a generated apartment.
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
# `needs` lists the sensors that it reads.

# %%
import numpy as np

from mitigate.core.observation import FORWARD, LEFT


class AvoidObstacles:
    needs = ("depth",)

    def reset(self, instruction):
        pass  # the policy ignores the instruction

    def act(self, observation):
        depth = observation["depth"]
        middle = depth[depth.shape[0] // 3 : 2 * depth.shape[0] // 3]
        return LEFT if np.percentile(middle, 20) < 0.6 else FORWARD


# %% [markdown]
# ## The recording
#
# `open_recording` reads the structure of a bag, `load` its frames. `views=1` is a single camera. The frames are cut to
# square views of 64 pixels, one per 0.25 metres or 15 degrees of motion.

# %%
from pathlib import Path

from mitigate.worlds.recorded import Step, load, open_recording

bag = next(Path("runs/drives").glob("*.bag"))
(source,) = open_recording(bag)
recording = load(source, views=1, size=64, step=Step())

# %% [markdown]
# ## Decisions
#
# The robot drives as recorded, whatever the policy answers. Each decision asks: what would it do now?

# %%
from mitigate.corruptions import CLEAN, Corruption
from mitigate.replay.walk import walk

policy = AvoidObstacles()
clean = walk(policy, recording, CLEAN, seed=0)
for name in ("gaussian_noise", "missing_data", "quantization"):
    corrupted = walk(policy, recording, Corruption(name, 0.6), seed=0, clean=clean)
    changed = np.mean(clean.actions != corrupted.actions)
    print(f"{name}: {100 * changed:.0f} % of {len(clean.actions)} decisions change")

# %% [markdown]
# For agents with weights in a folder, the command `mitigate replay` does the same and writes a table with intervals:
#
# ```bash
# mitigate replay runs/drives agents=[checkpoints/recurrent/base,checkpoints/recurrent/teacher]
# ```
