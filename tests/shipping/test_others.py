"""Tests that a card contains rows of one agent, and that a folder loads only into an agent of the
same kind."""

from __future__ import annotations

import warnings

import pytest
import yaml

from mitigate.agents.loading import check_same, give_settings, load, load_hardened
from mitigate.shipping.export import _of_one_agent
from tests.evaluation.made_rows import row


def rows(agent: str, wins: bool) -> list[dict]:
    return [{**row(f"e{n}", wins), "agent": agent, "weights": "w" * 12} for n in range(3)]


def test_run_rows_identify_agents_of_equal_weights():
    own_rows, blind = rows("a" * 12, True), rows("b" * 12, False)
    matches = list(_of_one_agent(own_rows[:1], own_rows + blind, {"w" * 12}))
    assert {r["agent"] for r in matches} == {"a" * 12} and len(matches) == 3
    with pytest.raises(ValueError, match="several agents with these weights"):
        list(_of_one_agent([], own_rows + blind, {"w" * 12}))


def test_rows_of_before_are_known_by_their_weights():
    old = [{**row("e0", True), "agent": "w" * 12}]
    assert list(_of_one_agent([], old, {"w" * 12})) == old


def test_rows_of_other_weights_are_left_out():
    assert list(_of_one_agent([], rows("a" * 12, True), {"v" * 12})) == []


class Mine:
    def __init__(self, gain: float) -> None:
        self.gain = gain

    def settings(self) -> dict:
        return {"gain": self.gain}


def test_agent_with_other_settings_is_rejected(tmp_path):
    config = tmp_path / "config.yaml"
    config.write_text(yaml.safe_dump({"agent": {"_target_": "mine.Mine", "gain": -1.0}}))
    check_same(Mine(-1.0), config, "")
    with pytest.raises(ValueError, match=r"with gain=-1.0, but the given agent has 5.0"):
        check_same(Mine(5.0), config, "")


class Scaled:
    settings = {"scales": (1, 2)}


def test_settings_may_be_a_mapping_and_tuples_become_lists(tmp_path):
    config = tmp_path / "config.yaml"
    config.write_text(yaml.safe_dump({"agent": {"_target_": "mine.Scaled", "scales": [1, 2]}}))
    check_same(Scaled(), config, "")
    config.write_text(yaml.safe_dump({"agent": {"_target_": "mine.Scaled", "scales": [1, 3]}}))
    with pytest.raises(ValueError, match="with scales="):
        check_same(Scaled(), config, "")


@pytest.mark.parametrize("filled", [load, load_hardened])
def test_values_that_cannot_be_loaded_are_named(filled):
    folder = "checkpoints/hardened/ts_distill" if filled is load_hardened else "checkpoints/base"
    with pytest.raises(TypeError, match="must be a torch.nn.Module .*, got <class .*Silent"):
        filled(folder, agent=Silent)
    with pytest.raises(TypeError, match="must be a torch.nn.Module with weights, got <object"):
        filled(folder, agent=object())


class Silent:
    """An agent without settings(); its attribute ``net`` is an object and not plain data."""

    def __init__(self, gain: float) -> None:
        self.gain, self.net = gain, object()


def test_attributes_are_compared_without_settings(tmp_path):
    """Attributes must match the stored settings; then the agent gets these settings.

    As a result, an evaluation and ``benchmark(load_hardened(...))`` compute the same hash.
    """
    config = tmp_path / "config.yaml"
    config.write_text(yaml.safe_dump({"agent": {"_target_": "mine.Silent", "gain": 1, "net": "a"}}))
    with pytest.warns(UserWarning, match=r"with gain=1, but the given agent has 5\.0"):
        check_same(Silent(5.0), config, "")
    agent = Silent(1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_same(agent, config, "")
    give_settings(agent, config, "")
    assert agent.settings() == {"gain": 1, "net": "a"}
    reported = Mine(2.0)
    give_settings(reported, config, "")
    assert reported.settings() == {"gain": 2.0}
