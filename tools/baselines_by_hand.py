"""Run habitat-baselines' PPO agent under `mitigate run`, on this project's scenes and episodes.

    mitigate export_scene habitat/
    python tools/baselines_by_hand.py habitat/ train
    mitigate run conditions=[low_light] -- python tools/baselines_by_hand.py habitat/ evaluate

This program uses the trainer and evaluator of habitat-baselines (ObjectNav, two workers,
ResNet-18), and prints means of the policy's input. It needs habitat-sim (docs/habitat.md),
habitat-lab and habitat-baselines 0.3. The wheel of habitat-baselines lacks its YAML files, which
are in its repository. Two updates do not train a useful policy: the program only shows that the
policy's input is corrupted.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import Any

CHECKPOINTS = "baselines"
TRAINING = """
habitat_baselines.trainer_name=ppo habitat_baselines.num_environments=2
habitat_baselines.rl.ddppo.backbone=resnet18 habitat_baselines.rl.ddppo.pretrained=False
habitat_baselines.rl.ddppo.pretrained_encoder=False habitat_baselines.rl.ppo.num_steps=16
habitat_baselines.rl.ppo.hidden_size=64 habitat_baselines.num_updates=2
habitat_baselines.num_checkpoints=1 habitat_baselines.total_num_steps=-1.0
habitat.environment.max_episode_steps=60 habitat.simulator.habitat_sim_v0.gpu_device_id=-1
habitat.dataset.split=val_unseen habitat_baselines.eval.split=val_unseen
"""


def options(folder: Path, evaluate: bool, episodes: int) -> list[str]:
    """Return the Hydra options of ``habitat_baselines.run``."""
    dataset = folder / "datasets/objectnav/val_unseen/val_unseen.json.gz"
    return [
        "--config-name=objectnav/ddppo_objectnav_hm3d",
        *TRAINING.split(),
        f"habitat.dataset.data_path={dataset}",
        f"habitat.dataset.scenes_dir={folder / 'scenes'}",
        f"habitat_baselines.checkpoint_folder={CHECKPOINTS}",
        f"habitat_baselines.eval_ckpt_path_dir={CHECKPOINTS}/ckpt.0.pth",
        f"habitat_baselines.tensorboard_dir={CHECKPOINTS}/tb",
        f"habitat_baselines.test_episode_count={episodes}",
        f"habitat_baselines.evaluate={evaluate}",
    ]


def print_batches() -> None:
    """Print the means of every fifth batch that the policy receives."""
    from habitat_baselines.rl.ppo import habitat_evaluator

    original = habitat_evaluator.apply_obs_transforms_batch
    calls: list[int] = []

    def print_means(batch: Any, transforms: Any) -> Any:
        calls.append(1)
        if len(calls) % 5 == 1:
            means = {n: round(float(batch[n].float().mean()), 3) for n in ("rgb", "depth")}
            print("batch", len(calls), means, flush=True)
        return original(batch, transforms)

    habitat_evaluator.apply_obs_transforms_batch = print_means


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("habitat", type=Path, help="folder of mitigate export_scene")
    parser.add_argument("what", choices=("train", "evaluate"))
    parser.add_argument("--episodes", type=int, default=6)
    arguments = parser.parse_args()
    evaluate = arguments.what == "evaluate"
    # the checkpoint contains a pickled config, which torch >= 2.6 rejects; this program wrote it
    os.environ["TORCH_FORCE_NO_WEIGHTS_ONLY_LOAD"] = "1"
    from habitat.config.default_structured_configs import register_hydra_plugin
    from habitat_baselines import run
    from habitat_baselines.config.default_structured_configs import HabitatBaselinesConfigPlugin

    print_batches()
    register_hydra_plugin(HabitatBaselinesConfigPlugin)
    sys.argv[1:] = options(arguments.habitat.resolve(), evaluate, arguments.episodes)
    run.main()


if __name__ == "__main__":
    main()
