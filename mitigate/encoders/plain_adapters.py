"""Put the adapters of a folder into an encoder. Copy this one file into your project.

    from plain_adapters import attach

    encoder.eval()
    encoder = attach(encoder, "runs/encoder/agent")  # the folder of `make train RECIPE=encoder`

Needs Python 3.6, torch 1.7 and numpy or newer, and nothing else. The folder is data: JSON of a
fixed form and safetensors, compared with their sha256 and read here; nothing in it is run.
"""

import hashlib
import json
import os
import re

import numpy as np
import torch
import torch.nn.functional as F

WEIGHTS, SETTINGS, SUM = "adapters.safetensors", "adapters.json", ".sha256"
MANIFEST = "manifest.json"
LONGEST = 1 << 24  # bytes of a header (ours)
# of safetensors: name -> numpy's; BF16, which numpy lacks, is the upper half of a float32
TYPES = {"F64": "<f8", "F32": "<f4", "F16": "<f2", "BF16": "<u2", "I64": "<i8", "U8": "<u1"}
NUMBERS = {"channels": 1 << 20, "reduction": 1 << 20, "middle": 1 << 20, "kernel": 99, "batch": 1}


def attach(model, folder, check=True):
    """Put the adapters of ``folder`` behind the modules of ``model`` they were trained for.

    They work by forward hooks, follow the frames to their device and dtype, and do not train:
    ``model`` keeps its weights and its state dict. check: whether the weights of ``model`` must be
    those that the adapters were trained with, bit for bit (leave it out where ``model`` was
    converted to half precision first).

    Returns the model to use: ``model`` itself, or for TorchScript, which takes no hooks, a module
    around it. Raises ValueError for a folder that is damaged or does not fit and for a model that
    has adapters already, and OSError for a missing file.
    """
    # TorchScript may lack the attribute
    hooks = [hook for m in model.modules() for hook in getattr(m, "_forward_hooks", {}).values()]
    if any(isinstance(hook, _Adapter) for hook in hooks):
        raise ValueError(
            f"This model has adapters already, and those in {folder} would be added to them: build "
            "the model and load its weights again first."
        )
    settings, tensors = read(folder)
    shapes = settings["adapters"]
    owners = tuple(name.replace(".", "/") + "." for name in shapes)
    surplus = [name for name in tensors if not name.startswith(owners)]
    if surplus:
        raise ValueError(f"{WEIGHTS} in {folder} has tensors of no adapter: {surplus[0]!a:.60}.")
    modules = dict(model.named_modules())
    if set(shapes) <= {"before", "behind"} and "before" not in modules:
        model = _Wrapped(model)
        modules = dict(model.named_modules())
    missing = sorted(set(shapes) - set(modules))
    if missing:
        raise ValueError(
            "This model has no module called {}: the adapters in {} were trained for another "
            "one. It has, for instance, {}.".format(
                ", ".join(missing[:4]), folder, ", ".join(list(modules)[1:9])
            )
        )
    if check and backbone_sha(model) != settings["backbone_sha256"]:
        raise ValueError(
            "The adapters in {} were trained with weights of sha256 {}, but this model has {}. "
            "Load those weights first; to convert the model, or where it is the same in other "
            "words, attach(model, folder, check=False).".format(
                folder, settings["backbone_sha256"], backbone_sha(model)
            )
        )
    made = {name: _Adapter(folder, name, shape, tensors) for name, shape in shapes.items()}
    for name, adapter in made.items():
        modules[name].register_forward_hook(adapter)
    return model


class _Wrapped(torch.nn.Module):
    """A model between two places that take hooks."""

    def __init__(self, model):
        super().__init__()
        self.before, self.model, self.behind = torch.nn.Identity(), model, torch.nn.Identity()

    def forward(self, frames):
        return self.behind(self.model(self.before(frames)))


class _Adapter:
    """A forward hook: ``x + gate * up(gelu(down(x)))``."""

    def __init__(self, folder, name, shape, tensors):
        prefix = name.replace(".", "/") + "."
        own = {k[len(prefix) :]: v for k, v in tensors.items() if k.startswith(prefix)}
        wanted = _shapes(shape)
        good = {k: tuple(v.shape) for k, v in own.items()} == wanted
        good = good and all(v.is_floating_point() for v in own.values())
        if not good or not all(bool(torch.isfinite(v.float()).all()) for v in own.values()):
            raise ValueError(
                f"The adapter {name} in {folder} has other tensors than {SETTINGS} says, or some "
                "that are not all finite floats: fetch the folder again."
            )
        self.tokens, self.batch = shape.get("kind") == "tokens", shape.get("batch", 0)
        self.pad, self.own = shape.get("kernel", 1) // 2, own

    def __call__(self, module, inputs, output):
        if isinstance(output, (tuple, list)):
            rest = (self.adapt(output[0]),) + tuple(output[1:])
            # named tuples share no class of their own
            return output._make(rest) if hasattr(output, "_make") else type(output)(rest)
        return self.adapt(output)

    def fingerprint(self):
        """What this hook does, as plain data: mitigate reads it to tell agents apart."""
        return [self.tokens, self.batch, self.pad, tensors_sha(self.own)]

    def adapt(self, x):
        w = {name: value.to(x.device, x.dtype) for name, value in self.own.items()}
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
    """Names and shapes of an adapter's tensors by its settings."""
    channels = shape["channels"]
    middle = shape.get("middle") or max(4, channels // shape["reduction"])
    kernel = () if shape.get("kind") == "tokens" else (shape["kernel"],) * 2
    found = {"down.weight": (middle, channels) + kernel, "down.bias": (middle,)}
    found["up.weight"] = (channels, middle) + ((1, 1) if kernel else ())
    found["up.bias"] = (channels,)
    if shape.get("gate"):
        found["gate.read.weight"], found["gate.read.bias"] = (1, 2 * middle), (1,)
    return found


def _sums(folder):
    """The sha256 of the weights in the manifest, or beside them as earlier versions wrote it."""
    manifest = os.path.join(folder, MANIFEST)
    if not os.path.isfile(manifest):
        with open(os.path.join(folder, WEIGHTS + SUM), encoding="utf-8") as file:
            return re.findall(r"^([0-9a-f]{64})  ", file.read(LONGEST), re.MULTILINE)
    with open(manifest, encoding="utf-8") as file:
        text = file.read(LONGEST)
    try:
        held = json.loads(text)
        listed = [held["files"], held.get("replaced", {})]
        return [str(files[WEIGHTS]["sha256"]) for files in listed if WEIGHTS in files]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"{manifest} is damaged: fetch the folder again.") from error


def read(folder):
    """The settings and tensors of a folder: (dict, {name: tensor}). Errors as ``attach``."""
    folder = str(folder)
    path = os.path.join(folder, WEIGHTS)
    with open(path, "rb") as file:
        data = file.read()
    if hashlib.sha256(data).hexdigest() not in _sums(folder):
        raise ValueError(f"{path} does not have the sha256 beside it: fetch it again.")
    with open(os.path.join(folder, SETTINGS), encoding="utf-8") as file:
        text = file.read(LONGEST)
    try:
        settings = json.loads(text)
        good = isinstance(settings["backbone_sha256"], str) and isinstance(
            settings["adapters"], dict
        )
        good = good and len(settings["adapters"]) > 0
    except (ValueError, KeyError, TypeError, RecursionError):
        good = False
    if not good or not all(map(_known, settings["adapters"].values())):
        raise ValueError(
            f"{SETTINGS} in {folder} is damaged, or of adapters that this file does not know (ring "
            "adapters: use mitigate.agents.adapters.load_adapters)."
        )
    return settings, parse(data, path)


def _known(shape):
    """Whether the settings of an adapter are of the form that this file knows."""
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
    """The tensors in the bytes of a safetensors file, by name. Raises ValueError for damage.

    Form: 8 bytes length of the header, the header (JSON), the tensors' bytes.
    """
    try:
        length = int.from_bytes(data[:8], "little")
        if length > min(LONGEST, len(data) - 8):
            raise ValueError("the header is longer than the file")
        header = json.loads(data[8 : 8 + length].decode("utf-8"))
        body = memoryview(data)[8 + length :]
        found = {}
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
            found[name] = tensor.bfloat16() if entry["dtype"] == "BF16" else tensor
        return found
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"{path} is damaged ({error}): fetch it again.") from error


def backbone_sha(model):
    """The first 12 hex digits of the sha256 over names, types, shapes and bytes of the weights."""
    return tensors_sha(model.state_dict())


def tensors_sha(tensors):
    """As ``backbone_sha``, of tensors by name."""
    sha = hashlib.sha256()
    for name, value in sorted(tensors.items()):
        if isinstance(value, torch.Tensor):
            sha.update(f"{name} {value.dtype} {tuple(value.shape)}".encode())
            value = value.detach().cpu().contiguous()
            if value.dtype == torch.bfloat16:  # its two bytes are the upper ones of a float32
                sha.update((value.float().numpy().view("<u4") >> 16).astype("<u2").tobytes())
            else:
                sha.update(value.numpy().tobytes())
    return sha.hexdigest()[:12]
