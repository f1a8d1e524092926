# %% [markdown]
# # Harden an image encoder in your own training loop
#
# This tutorial puts zero-initialised adapters into a frozen encoder. It trains the adapters so that
# the features of a corrupted frame equal the features of the clean frame. No label, action or
# environment is needed. The tutorial takes about 20 seconds on a CPU.

# %%
import torch

from mitigate.agents.adapters import (
    adapter_parameters,
    insert_adapters,
    load_adapters,
    save_adapters,
)
from mitigate.corruptions import Key, corrupt, example_rgb

torch.manual_seed(0)


def make_encoder():
    """Return a small convolutional encoder with fixed weights. Use your pretrained encoder here."""
    generator = torch.Generator().manual_seed(0)
    encoder = torch.nn.Sequential()
    for index, (inputs, outputs) in enumerate(((3, 16), (16, 32), (32, 64)), start=1):
        layer = torch.nn.Conv2d(inputs, outputs, kernel_size=3, stride=2, padding=1)
        torch.nn.init.kaiming_normal_(layer.weight, generator=generator)
        torch.nn.init.zeros_(layer.bias)
        encoder.add_module(f"layer{index}", torch.nn.Sequential(layer, torch.nn.ReLU()))
    return encoder.eval()


# %% [markdown]
# ## Frames
#
# The frames are random crops of the photograph that the package ships. Each crop exists twice: clean and corrupted.

# %%
PHOTOGRAPH = example_rgb()
NAMES = ("low_light", "spatter", "foreign_object", "defocus")


def to_tensor(frame):
    return torch.from_numpy(frame).permute(2, 0, 1).float() / 127.5 - 1


def batch(step, size=8):
    """Return clean and corrupted crops, each float32 [size, 3, 48, 48]."""
    generator = torch.Generator().manual_seed(step)
    clean, corrupted = [], []
    for index in range(size):
        top = int(torch.randint(0, 400 - 48, (), generator=generator))
        left = int(torch.randint(0, 600 - 48, (), generator=generator))
        crop = PHOTOGRAPH[top : top + 48, left : left + 48].copy()
        name = NAMES[index % len(NAMES)]
        key = Key(seed=0, episode=str(step), frame=index)
        clean.append(to_tensor(crop))
        corrupted.append(to_tensor(corrupt(crop, name, 0.6, key=key)))
    return torch.stack(clean), torch.stack(corrupted)


# %% [markdown]
# ## Adapters
#
# Inserting the adapters does not change the outputs of the encoder by a single bit, because the
# last layer of each adapter is zero.

# %%
encoder = make_encoder()
clean, corrupted = batch(step=10_000)
with torch.no_grad():
    target = encoder(clean)
    insert_adapters(encoder, target_modules=["layer[1-3]"], reduction=4)
    assert torch.equal(encoder(clean), target)
    error_before = torch.nn.functional.mse_loss(encoder(corrupted), target).item()

# %% [markdown]
# ## Training

# %%
teacher = make_encoder()
optimizer = torch.optim.AdamW(adapter_parameters(encoder), lr=5e-3)
for step in range(80):
    frames, corrupted_frames = batch(step)
    with torch.no_grad():
        features = teacher(frames)
    loss = torch.nn.functional.mse_loss(encoder(corrupted_frames), features)
    optimizer.zero_grad()
    loss.backward()
    optimizer.step()

with torch.no_grad():
    error_after = torch.nn.functional.mse_loss(encoder(corrupted), target).item()
print(
    f"feature error on held-out crops: {error_before:.3f} before, {error_after:.3f} after training"
)

# %% [markdown]
# ## Save and load
#
# The folder holds safetensors and JSON. It can only be loaded into an encoder with the same
# weights.

# %%
save_adapters(encoder, "runs/my-adapters")
restored = make_encoder()
load_adapters(restored, "runs/my-adapters")
with torch.no_grad():
    assert torch.equal(restored(corrupted), encoder(corrupted))
