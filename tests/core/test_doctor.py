"""Tests that ``mitigate doctor`` reports the processor's features and whether there is a
compiler."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

import pytest
import torch

from mitigate.core import doctor

OLD = {"sse4_1", "avx2"}
MIDDLE = OLD | {"avx512f", "avx512bw", "avx512dq", "avx512vl"}
NEW = MIDDLE | {"avx512_bf16"}
NEWEST = NEW | {"amx_bf16", "amx_tile"}


@pytest.mark.parametrize(
    ("flags", "words"),
    [
        (OLD, "AVX2, no AVX-512, no native bf16"),
        (MIDDLE, "AVX2, AVX-512, no native bf16"),
        (NEW, "AVX2, AVX-512, native bf16"),
        (NEWEST, "AVX2, AVX-512, native bf16, bf16 matrices (AMX)"),
        ({"sse4_1"}, "no AVX2, no AVX-512, no native bf16"),
        (set(), "unknown (no flags in /proc/cpuinfo)"),
    ],
)
def test_processor_names_the_instruction_sets(flags, words):
    assert doctor.processor(flags) == words


def test_compiler_comes_from_path_or_cxx(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    assert doctor.compiler() is None
    for name in ("clang++", "mine"):
        (tmp_path / name).write_text("#!/bin/sh\n")
        (tmp_path / name).chmod(0o755)
    assert doctor.compiler() == str(tmp_path / "clang++")
    monkeypatch.setenv("CXX", "mine -O2")
    assert doctor.compiler() == str(tmp_path / "mine")


def test_missing_compiler_is_not_a_problem(capsys, monkeypatch):
    monkeypatch.setattr(doctor, "compiler", lambda: None)
    problems = doctor._machine()
    out = capsys.readouterr().out
    assert "missing (only torch.compile needs one)" in out
    assert not any("compiler" in problem for problem in problems)


@pytest.mark.skipif(sys.platform != "linux", reason="cores are counted otherwise")
def test_cores_are_those_that_this_process_may_use(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1})
    monkeypatch.setattr(os, "cpu_count", lambda: 8)
    assert doctor._cores() == "2 of 8"


def test_report_has_a_line_per_check(capsys):
    doctor.main([])
    out = capsys.readouterr().out
    for name in ("cores", "processor", r"C\+\+ compiler", "torch and CUDA"):
        assert re.search(rf"^{name} +\S", out, re.MULTILINE)
    flags = Path("/proc/cpuinfo")
    if flags.is_file() and "avx2" in flags.read_text():
        assert re.search(r"^processor +AVX2", out, re.MULTILINE)


@pytest.mark.parametrize(("value", "status"), [("--help", 0), ("foo", 2), ("--fix", 2)])
def test_doctor_rejects_options(value, status, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["mitigate doctor", value])
    with pytest.raises(SystemExit) as ended:
        doctor.main()
    printed = capsys.readouterr()
    assert ended.value.code == status and "processor" not in printed.out
    assert "usage: mitigate doctor" in (printed.err if status else printed.out)
    assert status == 0 or value in printed.err


@pytest.mark.parametrize(
    ("available", "built", "text"),
    [
        (True, "12.8", "sees H100, H100 (CUDA 12.8)"),
        (False, "12.8", "sees no GPU (built for CUDA 12.8)"),
        (False, None, "sees no GPU (built for CPUs only)"),
    ],
)
def test_cuda_describes_what_torch_sees(available, built, text, monkeypatch):
    monkeypatch.setattr(torch.cuda, "is_available", lambda: available)
    monkeypatch.setattr(torch.cuda, "device_count", lambda: 2)
    monkeypatch.setattr(torch.cuda, "get_device_name", lambda number: "H100")
    monkeypatch.setattr(torch.version, "cuda", built)
    assert doctor.cuda() == text
