"""The networks of ``programs.py`` as ONNX files, checked with onnxruntime (extra onnx)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from mitigate.agents.topological import TopologicalAgent
from mitigate.shipping import programs


def save_onnx(agent: TopologicalAgent, size: int, folder: Path, most: float) -> list[Path]:
    """Write ``perceive.onnx`` and ``decide.onnx`` to ``folder`` and return their paths.

    Weights are float32; the free dimensions are those of ``export_programs``. Raises ValueError if
    the extra is not installed, and as :func:`check_onnx`.
    """
    try:
        import onnx  # noqa: F401
        import onnxruntime  # noqa: F401
        import onnxscript  # noqa: F401
    except ImportError as error:
        raise ValueError(
            f"ONNX files need the extra onnx ({error}): pip install -e '.[onnx]'."
        ) from error
    given = programs.probe(agent, size)
    files = []
    for name, network in programs.networks(agent).items():
        files.append(folder / f"{name}.onnx")
        keys = tuple(programs.INPUTS[name])
        torch.onnx.export(
            network.eval(),
            tuple(given[key] for key in keys),
            files[-1],
            dynamo=True,
            dynamic_shapes=programs.free_dimensions(name),
            input_names=list(keys),
            output_names=list(programs.OUTPUTS[name]),
            external_data=False,
            verbose=False,
        )
    check_onnx(folder, agent, size, most)
    return files


def check_onnx(folder: Path, agent: TopologicalAgent, size: int, most: float) -> None:
    """Raise ValueError if an output of the ONNX files in ``folder`` on the probe, whole or with its
    first decision alone, differs from the agent's by more than ``most``."""
    import onnxruntime

    networks, given = programs.networks(agent), programs.probe(agent, size)
    sessions = {
        name: _Session(
            onnxruntime.InferenceSession(str(folder / f"{name}.onnx")),
            tuple(programs.INPUTS[name]),
        )
        for name in networks
    }
    first = {name: tensor[:1] for name, tensor in given.items()}
    kept = ("rgb", "depth", "views")
    for inputs in (given, {**first, **{name: given[name] for name in kept}}):
        gap = programs.difference(
            programs.outputs(networks, inputs), programs.outputs(sessions, inputs)
        )
        if not gap <= most:
            raise ValueError(
                f"The ONNX files differ from the agent by {gap:g}, more than {most:g}."
            )


class _Session:
    """An onnxruntime session, called like the network that it was made from."""

    def __init__(self, session: Any, keys: tuple[str, ...]) -> None:
        self._session, self._keys = session, keys

    def __call__(self, *inputs: Tensor) -> tuple[Tensor, ...]:
        feed = {key: tensor.numpy() for key, tensor in zip(self._keys, inputs, strict=True)}
        return tuple(torch.from_numpy(array) for array in self._session.run(None, feed))
