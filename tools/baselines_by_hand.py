"""habitat-baselines' PPO agent for `mitigate run`, over our scenes and episodes.

    mitigate export_scene habitat/
    python tools/baselines_by_hand.py habitat/ train
    mitigate run conditions=[low_light] -- python tools/baselines_by_hand.py habitat/ evaluate

Runs their own trainer and evaluator (ObjectNav, two workers, ResNet-18), and prints means of what
the policy is given. Needs habitat-sim (docs/habitat.md), habitat-lab and habitat-baselines 0.3; of
the latter the wheel lacks its YAML files, which are in its repository. Two updates teach nothing:
what is shown is that the frames on the way to a policy of theirs are corrupted.
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
    """Hydra's of ``habitat_baselines.run``."""
    listed = folder / "datasets/objectnav/val_unseen/val_unseen.json.gz"
    return [
        "--config-name=objectnav/ddppo_objectnav_hm3d",
        *TRAINING.split(),
        f"habitat.dataset.data_path={listed}",
        f"habitat.dataset.scenes_dir={folder / 'scenes'}",
        f"habitat_baselines.checkpoint_folder={CHECKPOINTS}",
        f"habitat_baselines.eval_ckpt_path_dir={CHECKPOINTS}/ckpt.0.pth",
        f"habitat_baselines.tensorboard_dir={CHECKPOINTS}/tb",
        f"habitat_baselines.test_episode_count={episodes}",
        f"habitat_baselines.evaluate={evaluate}",
    ]


def show() -> None:
    """Print the means of every fifth batch on its way to the policy."""
    from habitat_baselines.rl.ppo import habitat_evaluator

    real, calls = habitat_evaluator.apply_obs_transforms_batch, []

    def shown(batch: Any, transforms: Any) -> Any:
        calls.append(1)
        if len(calls) % 5 == 1:
            means = {n: round(float(batch[n].float().mean()), 3) for n in ("rgb", "depth")}
            print("batch", len(calls), means, flush=True)
        return real(batch, transforms)

    habitat_evaluator.apply_obs_transforms_batch = shown


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("habitat", type=Path, help="folder of mitigate export_scene")
    parser.add_argument("what", choices=("train", "evaluate"))
    parser.add_argument("--episodes", type=int, default=6)
    told = parser.parse_args()
    evaluate = told.what == "evaluate"
    # their checkpoints hold a pickled config, which torch has refused since 2.6: this one is ours
    os.environ["TORCH_FORCE_NO_WEIGHTS_ONLY_LOAD"] = "1"
    from habitat.config.default_structured_configs import register_hydra_plugin
    from habitat_baselines import run
    from habitat_baselines.config.default_structured_configs import HabitatBaselinesConfigPlugin

    show()
    register_hydra_plugin(HabitatBaselinesConfigPlugin)
    sys.argv[1:] = options(told.habitat.resolve(), evaluate, told.episodes)
    run.main()


if __name__ == "__main__":
    main()
