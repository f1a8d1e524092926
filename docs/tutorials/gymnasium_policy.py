# %% [markdown]
# # Benchmark a policy in a gymnasium environment
#
# This tutorial wraps a gymnasium environment as a world and measures a policy of another library (a torchrl actor)
# under three corruptions. It takes about half a minute on a CPU.
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
# The network is a torchrl `ConvNet` on depth. A short supervised training makes it predict whether the wall is
# within one metre. Replace it with your own trained policy.

# %%
torch.manual_seed(0)
network = torch.nn.Sequential(
    ConvNet(in_features=1, depth=1, num_cells=[4], kernel_sizes=32, strides=1),
    torch.nn.Linear(4, 2),
)
actor = TensorDictModule(network, in_keys=["depth"], out_keys=["logits"])
optimizer = torch.optim.Adam(actor.parameters(), lr=0.03)
for _ in range(150):
    distance = torch.rand(32) * 4.5 + 0.1
    depth = distance[:, None, None, None].expand(-1, 1, 32, 32)
    logits = actor(TensorDict({"depth": depth}, [32]))["logits"]
    loss = torch.nn.functional.cross_entropy(logits, (distance > 0.75).long())
    optimizer.zero_grad()
    loss.backward()
    optimizer.step()
print(f"training loss {loss.item():.3f}")

# %% [markdown]
# ## The adapter between both
#
# `mitigate` needs two methods: `reset` receives the instruction, `act` returns the number of an action.


# %%
class Policy:
    def __init__(self, actor):
        self.actor = actor

    def settings(self):
        return {}  # plain data that changes the behaviour, in addition to the weights

    def reset(self, instruction):
        pass

    @torch.no_grad()
    def act(self, observation):
        depth = torch.from_numpy(observation["depth"]).permute(2, 0, 1)
        return int(self.actor(TensorDict({"depth": depth}, []))["logits"].argmax())


def make_world():
    return GymWorld(Corridor(), success="success")


# %% [markdown]
# ## The benchmark
#
# The printed entry shows the success rate per condition and PRS. Missing depth reads as zero, so the policy stops
# too early. The rows are in `runs/corridor`; the same call continues a run that was interrupted.

# %%
if __name__ == "__main__":
    entry = mitigate.benchmark(
        Policy(actor),
        world=make_world,
        listed=seeded_episodes(range(20)),
        suite=["spatter", "gaussian_noise", "missing_data"],
        severity=0.6,
        out="runs/corridor",
        workers=1,
    )
    print(entry)
