# %% [markdown]
# # Measure and harden a policy in a gymnasium environment
#
# This tutorial wraps a gymnasium environment as a world. It measures a policy from another library (a
# torchrl actor) under three corruptions, and then makes the policy robust. The tutorial takes about
# a minute on a CPU.
#
# The environment is a corridor. Action 1 drives half a metre forward, action 0 stops. The episode succeeds if the
# robot stops within one metre of the wall.

# %%
import gymnasium
import numpy as np
import torch
from gymnasium import spaces
from tensordict import TensorDict
from tensordict.nn import TensorDictModule
from torchrl.modules import ConvNet

import mitigate
from mitigate.worlds.gym import GymWorld
from mitigate.worlds.seeded import seeded_episodes

STOP, FORWARD = 0, 1


class Corridor(gymnasium.Env):
    observation_space = spaces.Dict(
        {
            "rgb": spaces.Box(0, 255, (32, 32, 3), np.uint8),
            "depth": spaces.Box(0, 10, (32, 32, 1), np.float32),  # metres
        }
    )
    action_space = spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.distance = 2.0 + 0.5 * int(self.np_random.integers(0, 6))
        return self.observe(), {}

    def step(self, action):
        if action == FORWARD:
            self.distance -= 0.5
        stopped = action == STOP
        crashed = self.distance <= 0.0
        success = stopped and self.distance <= 1.0
        return self.observe(), 0.0, stopped or crashed, False, {"success": success}

    def observe(self):
        brightness = int(200 / max(self.distance, 1.0))
        return {
            "rgb": np.full((32, 32, 3), brightness, np.uint8),
            "depth": np.full((32, 32, 1), max(self.distance, 0.1), np.float32),
        }


# %% [markdown]
# ## The policy
#
# The network is a torchrl `ConvNet` on depth.
# A short supervised training run teaches it to predict whether the wall is within one metre.
# Replace the network with your own trained policy.


# %%
class ChannelsFirst(torch.nn.Module):
    def forward(self, depth):
        return depth.movedim(-1, -3)


torch.manual_seed(0)
network = torch.nn.Sequential(
    ChannelsFirst(),
    ConvNet(in_features=1, depth=2, num_cells=[8, 16], kernel_sizes=[8, 4], strides=[4, 2]),
    torch.nn.LazyLinear(64),
    torch.nn.ReLU(),
    torch.nn.Linear(64, 2),
)
actor = TensorDictModule(network, in_keys=["depth"], out_keys=["logits"])
# the lazy layer infers its shape from the input
actor(TensorDict({"depth": torch.zeros(1, 32, 32, 1)}, [1]))
optimizer = torch.optim.Adam(actor.parameters(), lr=0.003)
for _ in range(150):
    distance = torch.rand(32) * 4.5 + 0.1
    depth = distance[:, None, None, None].expand(-1, 32, 32, 1)
    logits = actor(TensorDict({"depth": depth}, [32]))["logits"]
    loss = torch.nn.functional.cross_entropy(logits, (distance > 0.75).long())
    optimizer.zero_grad()
    loss.backward()
    optimizer.step()
print(f"training loss {loss.item():.3f}")


# %% [markdown]
# ## The benchmark
#
# The printed entry shows the success rate under each corruption and PRS. Missing depth reads as zero, so the policy
# stops too early. The rows are in `runs/corridor`. If a run was interrupted, the same call continues it.


# %%
def make_world():
    return GymWorld(Corridor(), success="success")


suite = ["gaussian_noise", "missing_data", "multipath"]
if __name__ == "__main__":
    entry = mitigate.benchmark(
        actor, world=make_world, listed=seeded_episodes(range(20)), suite=suite, out="runs/corridor"
    )
    print(entry)

# %% [markdown]
# ## Hardening
#
# The actor teaches a copy of itself; the copy sees corrupted versions of the same depth frames.
# Neither an expert nor a reward is needed. The report compares the actor before and after hardening
# on the same episodes. In this tutorial, 300 training steps are enough; the default is 1,500.

# %%
if __name__ == "__main__":
    result = mitigate.harden(
        actor,
        make_world,
        listed=seeded_episodes(range(20)),
        suite=suite,
        steps=300,
        every=100,
        lr=1e-3,
        out="runs/corridor-hardened",
    )
    print(result)
    hardened_actor = result.policy  # still a TensorDictModule
