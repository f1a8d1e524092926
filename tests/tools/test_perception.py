"""Tests that perception scores fall under corruptions of the same modality, and no others."""

from __future__ import annotations

import pytest

from tools import perception


@pytest.fixture(scope="module")
def printed(request):
    with pytest.MonkeyPatch.context() as patch:
        lines: list[str] = []
        patch.setattr("builtins.print", lambda *text, **_: lines.extend(text))
        perception.main(["checkpoints/base", "--poses", "3"])
    return "\n".join(lines)


def value(printed: str, row: str) -> float:
    line = next(line for line in printed.splitlines() if line.startswith(f"| {row} "))
    return float(line.split("|")[2].split()[0])


@pytest.mark.slow
def test_measure_loses_things_or_free_space_by_corruption(printed):
    assert value(printed, "Foreign object") < 0.5 * value(printed, "Clean RGB")
    assert value(printed, "Missing data") < 0.7 * value(printed, "Clean depth")
    assert 0 < value(printed, "**Mean of RGB**") < value(printed, "Clean RGB")


def test_measure_equals_clean_at_severity_zero():
    poses = perception.Poses("val_seen", 2, seed=1)
    agent = perception.load(perception._agent_node(), "checkpoints/base")
    result = perception.measure(agent, poses, perception.SUITES["full"], severity=0.0)
    assert result["motion_blur"] == result["clean"] and result["multipath"] == result["clean depth"]


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["checkpoints/base", "--severity", "1.2", "--poses", "1"], "from 0"),
        (["checkpoints/base", "--poses", "0"], "must be >= 1"),
        (["checkpoints/nothing", "--poses", "1"], "no weights at"),
    ],
)
def test_main_rejects_invalid_options(arguments, message):
    with pytest.raises((ValueError, FileNotFoundError), match=message):
        perception.main(arguments)


def test_table_separates_agents_of_one_name():
    assert perception._column("runs/a/agent", ["base"]) == "a"
    assert perception._column("checkpoints/base", ["base"]) == "checkpoints/base"
