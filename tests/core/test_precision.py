"""Tests that bf16 is used only if supported, and that all processes use the same precision."""

from __future__ import annotations

import pytest
import torch

from mitigate.core import precision
from mitigate.core.precision import choose, computing, current, native
from mitigate.training import states
from mitigate.training.trainer import Trainer
from tests.tiny import TinyRecipe

CPU = torch.device("cpu")


@pytest.mark.parametrize(
    ("capabilities", "cap", "expected"),
    [
        ({"avx2": True}, "", False),
        ({"avx512_f": True}, "", False),  # without AVX512-BF16, bf16 would be emulated
        ({"avx512_bf16": True}, "", True),
        ({"amx_bf16": True}, "", True),
        ({"bf16": True}, "", True),  # Arm
        ({"avx512_bf16": True}, "AVX2", False),
        ({"avx512_bf16": True}, "avx512_core_vnni", False),
        ({"avx512_bf16": True}, "AVX512_CORE_BF16", True),
        ({"amx_bf16": True}, "ALL", True),
    ],
)
def test_bf16_is_native_with_its_instructions_and_no_lower_cap(
    capabilities, cap, expected, monkeypatch
):
    monkeypatch.setattr(torch.cpu, "get_capabilities", lambda: capabilities)
    monkeypatch.setenv(precision.CAP, cap)
    assert native() is expected


@pytest.mark.parametrize(("is_native", "expected"), [(False, "fp32"), (True, "bf16")])
def test_choose_auto_depends_on_the_instructions_alone(is_native, expected, monkeypatch):
    monkeypatch.setattr(precision, "native", lambda: is_native)
    monkeypatch.setattr(precision, "probe", lambda: pytest.fail("a timing differs between runs"))
    assert choose("auto", CPU) == expected
    assert choose("fp32", CPU) == "fp32" and choose("bf16", CPU) == "bf16"


def test_probe_returns_milliseconds_and_leaves_the_generator_alone():
    before = torch.get_rng_state()
    precision.probe.cache_clear()
    assert 0 < precision.probe() < 5000
    assert torch.equal(torch.get_rng_state(), before)


def test_context_reports_its_precision():
    product = torch.ones(2, 2)
    for kind, dtype in (("fp32", torch.float32), ("bf16", torch.bfloat16)):
        with computing(kind, CPU):
            assert current(CPU) == kind and (product @ product).dtype == dtype
    assert current(CPU) == "fp32"


class Watching(TinyRecipe):
    """An objective that records the precision in which each of its parts ran."""

    def __init__(self) -> None:
        super().__init__()
        self.seen: dict[str, str] = {}

    def start(self) -> None:
        self.seen["start"] = current(CPU)

    def batch(self, step: int) -> dict:
        self.seen["batch"] = current(CPU)
        return super().batch(step)

    def forward(self, batch: dict) -> dict:
        self.seen["forward"] = current(CPU)
        return super().forward(batch)


@pytest.mark.parametrize("kind", ["fp32", "bf16"])
def test_preparation_batches_and_networks_obey_the_trainers_precision(kind, tmp_path):
    recipe = Watching()
    Trainer(recipe, steps=1, folder=tmp_path, precision=kind).fit()
    assert recipe.seen == {"start": kind, "batch": kind, "forward": kind}


def test_run_keeps_its_precision_on_another_machine(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(precision, "native", lambda: True)
    Trainer(TinyRecipe(), steps=4, save_every=2, folder=tmp_path).fit()
    saved = states.checkpoints(tmp_path)
    assert states.load(saved[-1])["config"]["trainer"]["precision"] == "bf16"
    saved[-1].unlink()
    monkeypatch.setattr(precision, "native", lambda: False)
    resumed = Trainer(TinyRecipe(), steps=4, save_every=2, folder=tmp_path)
    resumed.fit()
    assert resumed.precision == "bf16"
    assert "resumes in its first precision bf16" in capsys.readouterr().out


def test_explicit_other_precision_is_another_run(tmp_path):
    Trainer(TinyRecipe(), steps=2, folder=tmp_path, precision="bf16").fit()
    with pytest.raises(ValueError, match=r"trainer\.precision: bf16 -> fp32"):
        Trainer(TinyRecipe(), steps=2, folder=tmp_path, precision="fp32").fit()
