"""Load adapters from a folder into an encoder. To use this module, copy it into your project.

    from plain_adapters import attach

    encoder.eval()
    encoder = attach(encoder, "runs/encoder/agent")  # the folder of `make train RECIPE=encoder`

It needs only Python 3.6, torch 1.7 and numpy, or newer versions. The folder contains only data, as
JSON and safetensors files. This module checks the sha256 of the weights and parses the files. It
runs no code from the folder.
"""

import hashlib
import json
import os

import numpy as np
import torch
import torch.nn.functional as F

WEIGHTS, SETTINGS = "adapters.safetensors", "adapters.json"
MANIFEST = "manifest.json"
LONGEST = 1 << 24  # maximum size of a header in bytes (heuristic)
LARGEST = 1 << 30  # maximum size of the weights in bytes (heuristic; usual sizes are 1e5 to 1e7)
# This table maps safetensors types to numpy types.
# numpy lacks BF16, which is read as the upper half of a float32.
TYPES = {"F64": "<f8", "F32": "<f4", "F16": "<f2", "BF16": "<u2", "I64": "<i8", "U8": "<u1"}
NUMBERS = {"channels": 1 << 20, "reduction": 1 << 20, "middle": 1 << 20, "kernel": 99, "batch": 1}


def attach(model, folder, check=True):
    """Attach the adapters in ``folder`` to the modules of ``model`` for which they were trained.

    The adapters are frozen forward hooks that move to the device and dtype of the frames.
    ``model`` keeps its weights and its state dict.

    Args:
        model: the encoder.
        folder: the folder of the adapters.
        check: whether ``model`` must have exactly the weights that the adapters were trained with.
            Disable the check if ``model`` was already converted to half precision.

    Returns:
        ``model`` itself.

    Raises:
        ValueError: If the folder is damaged or does not match the model, or if the model already
            has adapters.
        OSError: If a file is missing.
    """
    hooks = [hook for m in model.modules() for hook in m._forward_hooks.values()]
    if any(isinstance(hook, _Adapter) for hook in hooks):
        raise ValueError(
            f"This model has adapters already, and those in {folder} would be added to them. "
            "Construct the model and load its weights again first."
        )
    settings, tensors = read(folder)
    shapes = settings["adapters"]
    owners = tuple(name.replace(".", "/") + "." for name in shapes)
    surplus = [name for name in tensors if not name.startswith(owners)]
    if surplus:
        raise ValueError(
            f"{WEIGHTS} in {folder} has a tensor that belongs to no adapter: {surplus[0]!a:.60}."
        )
    modules = dict(model.named_modules())
    missing = sorted(set(shapes) - set(modules))
    if missing:
        raise ValueError(
            f"The adapters in {folder} are for another model: this one has no module called "
            f"{', '.join(missing[:4])}. Its modules include {', '.join(list(modules)[1:9])}."
        )
    if check and backbone_sha(model) != settings["backbone_sha256"]:
        raise ValueError(
            f"The adapters in {folder} were trained with weights of sha256 "
            f"{settings['backbone_sha256']}, but this model has {backbone_sha(model)}. Load "
            "weights with the first hash. If only the dtype differs, call attach(..., check=False)."
        )
    adapters = {name: _Adapter(folder, name, shape, tensors) for name, shape in shapes.items()}
    for name, adapter in adapters.items():
        modules[name].register_forward_hook(adapter)
    return model


class _Adapter:
    """Forward hook with an adapter that computes ``x + gate * up(gelu(down(x)))``."""

    def __init__(self, folder, name, shape, tensors):
        prefix = name.replace(".", "/") + "."
        weights = {k[len(prefix) :]: v for k, v in tensors.items() if k.startswith(prefix)}
        valid = {k: tuple(v.shape) for k, v in weights.items()} == _shapes(shape)
        valid = valid and all(v.is_floating_point() for v in weights.values())
        if not valid or not all(bool(torch.isfinite(v.float()).all()) for v in weights.values()):
            raise ValueError(
                f"The tensors of the adapter {name} in {folder} must be finite floats of the "
                f"shapes in {SETTINGS}. Fetch the folder again."
            )
        self.tokens = shape.get("kind") == "tokens"
        self.batch = shape.get("batch", 0)
        self.pad = shape.get("kernel", 1) // 2
        self.weights = weights

    def __call__(self, module, inputs, output):
        if isinstance(output, (tuple, list)):
            rest = (self.adapt(output[0]),) + tuple(output[1:])
            # named tuples have no common base class, but only they have _make
            return output._make(rest) if hasattr(output, "_make") else type(output)(rest)
        return self.adapt(output)

    def fingerprint(self):
        """Return what determines the output of this hook, for mitigate's fingerprint of agents."""
        return [self.tokens, self.batch, self.pad, tensors_sha(self.weights)]

    def adapt(self, x):
        w = {name: value.to(x.device, x.dtype) for name, value in self.weights.items()}
        if self.tokens:
            y = F.layer_norm(x, (x.shape[-1],))
            y = F.gelu(F.linear(y, w["down.weight"], w["down.bias"]))
            z = F.linear(y, w["up.weight"], w["up.bias"])
            over = tuple(axis for axis in range(x.dim() - 1) if axis != self.batch)
        else:
            y = F.gelu(F.conv2d(x, w["down.weight"], w["down.bias"], padding=self.pad))
            z = F.conv2d(y, w["up.weight"], w["up.bias"])
            over = (2, 3)
        if "gate.read.weight" in w:
            mean, power = (y.mean(over), (y * y).mean(over)) if over else (y, y * y)
            seen = torch.cat([mean, (power + 1e-6).sqrt()], 1)
            gate = F.linear(seen, w["gate.read.weight"], w["gate.read.bias"])[:, 0]
            shape = [1] * x.dim()
            shape[self.batch] = -1
            z = z * gate.sigmoid().view(shape)
        return x + z


def _shapes(shape):
    """Return a dict from tensor name to shape, for an adapter with the settings ``shape``."""
    channels = shape["channels"]
    middle = shape.get("middle") or max(4, channels // shape["reduction"])
    kernel = () if shape.get("kind") == "tokens" else (shape["kernel"],) * 2
    shapes = {"down.weight": (middle, channels) + kernel, "down.bias": (middle,)}
    shapes["up.weight"] = (channels, middle) + ((1, 1) if kernel else ())
    shapes["up.bias"] = (channels,)
    if shape.get("gate"):
        shapes["gate.read.weight"] = (1, 2 * middle)
        shapes["gate.read.bias"] = (1,)
    return shapes


def _sums(folder):
    """Return the allowed sha256 values of the weights, from the manifest."""
    manifest = os.path.join(folder, MANIFEST)
    with open(manifest, encoding="utf-8") as file:
        text = file.read(LONGEST)
    try:
        entries = json.loads(text)
        listed = [entries["files"], entries.get("replaced", {})]
        return [str(files[WEIGHTS]["sha256"]) for files in listed if WEIGHTS in files]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"{manifest} is damaged. Fetch the folder again.") from error


def read(folder):
    """Return the settings (a dict) and the tensors (by name) of a folder.

    Raises the same errors as ``attach``.
    """
    folder = str(folder)
    path = os.path.join(folder, WEIGHTS)
    if os.path.getsize(path) > LARGEST:
        raise ValueError(f"{path} must not be larger than {LARGEST} bytes. Fetch the folder again.")
    with open(path, "rb") as file:
        data = file.read()
    if hashlib.sha256(data).hexdigest() not in _sums(folder):
        raise ValueError(f"{path} does not have the sha256 of the manifest. Fetch it again.")
    with open(os.path.join(folder, SETTINGS), encoding="utf-8") as file:
        text = file.read(LONGEST)
    try:
        settings = json.loads(text)
        valid = isinstance(settings["backbone_sha256"], str) and isinstance(
            settings["adapters"], dict
        )
        valid = valid and len(settings["adapters"]) > 0
    except (ValueError, KeyError, TypeError, RecursionError):
        valid = False
    if not valid or not all(map(_known, settings["adapters"].values())):
        raise ValueError(
            f"{SETTINGS} in {folder} is damaged, or has adapters that this module does not support "
            "(load ring adapters with mitigate.agents.adapters.load_adapters)."
        )
    return settings, parse(data, path)


def _known(shape):
    """Return whether the settings of an adapter are valid and supported by this module."""
    if not isinstance(shape, dict) or not {"channels", "reduction"} <= set(shape):
        return False
    rest = {name: value for name, value in shape.items() if name not in ("kind", "gate")}
    for name, value in rest.items():
        low = 0 if name == "batch" else 1
        if type(value) is not int or not low <= value <= NUMBERS.get(name, -1):
            return False
    if shape.get("gate", True) is not True or shape.get("kind", "tokens") != "tokens":
        return False
    return shape.get("kernel", 0) % 2 == 1 or "kind" in shape


def parse(data, path="the file"):
    """Parse the bytes of a safetensors file, and return its tensors by name.

    Such a file contains the length of the header (8 bytes), the header (JSON), and the bytes of the
    tensors. Raises ValueError if the data are damaged.
    """
    try:
        length = int.from_bytes(data[:8], "little")
        if length > min(LONGEST, len(data) - 8):
            raise ValueError("the header is longer than the file")
        header = json.loads(data[8 : 8 + length].decode("utf-8"))
        body = memoryview(data)[8 + length :]
        tensors = {}
        for name, entry in header.items():
            if name == "__metadata__":
                continue
            begin, end = entry["data_offsets"]
            if not 0 <= begin <= end <= len(body):
                raise ValueError(f"{name} lies outside the file")
            values = np.frombuffer(body[begin:end], TYPES[entry["dtype"]])
            if entry["dtype"] == "BF16":
                values = (values.astype("<u4") << 16).view("<f4")
            tensor = torch.from_numpy(values.reshape(entry["shape"]).copy())
            tensors[name] = tensor.bfloat16() if entry["dtype"] == "BF16" else tensor
        return tensors
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"{path} is damaged ({error}). Fetch it again.") from error


def backbone_sha(model):
    """Return 12 hex digits of the sha256 over names, types, shapes and bytes of the weights."""
    return tensors_sha(model.state_dict())


def tensors_sha(tensors):
    """Return the same hash as ``backbone_sha`` for named tensors."""
    sha = hashlib.sha256()
    for name, value in sorted(tensors.items()):
        if isinstance(value, torch.Tensor):
            sha.update(f"{name} {value.dtype} {tuple(value.shape)}".encode())
            value = value.detach().cpu().contiguous()
            if value.dtype == torch.bfloat16:  # the bytes of BF16 are the upper half of a float32
                sha.update((value.float().numpy().view("<u4") >> 16).astype("<u2").tobytes())
            else:
                sha.update(value.numpy().tobytes())
    return sha.hexdigest()[:12]
