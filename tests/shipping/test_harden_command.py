"""``mitigate harden``: the options in conf/harden.yaml are passed to mitigate.harden as
arguments."""

import sys
from inspect import signature

import pytest

from mitigate.cli import main
from mitigate.core import conf
from mitigate.core.build import imported
from mitigate.shipping.harden import harden
from mitigate.shipping.harden_command import HardenConfig, run

HERE = "tests.shipping.test_harden"
NAMES = [f"policy={HERE}:trained", f"world={HERE}:world"]
SHORT = ["+settings.every=3", "+settings.episodes=2", "+settings.batch=8", "steps=6"]


def config(*options: str) -> HardenConfig:
    return conf.typed(conf.composed("harden", [*NAMES, *options]), "harden")


@pytest.mark.slow
def test_harden_command_prints_the_comparison_and_writes_the_weights(tmp_path, capsys):
    options = ["test_episodes=4", "conditions=[low_light,spatter]", "validation=0"]
    with pytest.raises(SystemExit) as exit_info:
        main(["harden", *NAMES, *SHORT, *options, f"out={tmp_path}/run"])
    assert not exit_info.value.code
    assert "SR (%), mean of 2 corruptions" in capsys.readouterr().out
    assert (tmp_path / "run/agent/model.safetensors").is_file()


def test_harden_config_has_the_defaults_of_the_function():
    parameters = signature(harden).parameters
    defaults = vars(HardenConfig())
    shared = set(parameters) & set(defaults) - {"policy", "world", "suite", "settings"}
    assert len(shared) > 12
    assert {name: parameters[name].default for name in shared} == {
        name: defaults[name] for name in shared
    }
    assert vars(config()) | {"suite": None, "policy": None, "world": None} == defaults | {
        "suite": None
    }


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["policy=null"], "policy must be module:callable"),
        ([f"policy={HERE}:train"], "Did you mean trained?"),
        (["policy=missing_module:load"], "cannot be imported"),
        ([f"world={HERE}:SHORT"], "must be callable, got type dict"),
        (["test_episodes=0"], "test_episodes must be a whole number >= 1, got 0"),
        (["+settings.lr=1"], "Write lr=VALUE"),
    ],
)
def test_harden_command_explains_invalid_options(options, message):
    with pytest.raises(ValueError, match=message.replace("?", r"\?")):
        run(config(*options))


def test_harden_command_explains_settings_that_are_no_mapping(capsys):
    with pytest.raises(SystemExit, match=r"write \+settings.NAME=VALUE"):
        main(["harden", *NAMES, "settings=3"])


def test_imported_returns_the_callable():
    assert imported("sys:exit", "policy") is sys.exit
