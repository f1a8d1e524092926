"""Success rates that a schedule draws by: the same for any number of processes."""

from __future__ import annotations

from functools import partial

import torch

from mitigate.core.precision import computing
from mitigate.corruptions import Schedule
from mitigate.evaluation.evaluator import EpisodeTask
from mitigate.training.success import measure
from mitigate.worlds.apartments.tasks import DrawnEpisodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.agents.rooms import wanderer


def test_rates_do_not_depend_on_the_number_of_processes(capsys):
    agent, world = wanderer(stop=0.0).train(), partial(ApartmentsWorld, 16)
    schedule = Schedule("success_distributed", 0.6, names=("flare", "missing_data"))
    options = {"episodes": 2, "seed": 0, "step": 60}
    none, alone, two = (
        measure(agent, schedule, world, DrawnEpisodes(2), **options, workers=n) for n in (0, 1, 2)
    )
    assert none == alone == two and set(alone) == {"flare", "missing_data"} and not agent.training
    assert "success at step 60: 4 walks" in capsys.readouterr().out


def test_episodes_are_walked_in_fp32_inside_a_training_in_bf16():
    """Or rates would depend on who measures: this process, or workers of its own."""
    cpu = torch.device("cpu")
    with computing("bf16", cpu), EpisodeTask(wanderer(), partial(ApartmentsWorld, 16)).ready():
        assert not torch.is_autocast_enabled("cpu")
    with computing("bf16", cpu):
        assert torch.is_autocast_enabled("cpu")
