"""Write the clean RGB frames that a policy sees in its training episodes, one folder per episode.

    python -m tools.third_party.frames vizdoom_basic --out runs/frames/vizdoom

``make train RECIPE=restore ARGS="env=frames env.path=runs/frames/vizdoom agent.sensors=[rgb]"``
trains a restorer on them.
"""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

import cv2

import mitigate
from mitigate.core.files import make_folder, write_bytes
from mitigate.core.observation import RGB
from mitigate.worlds.seeded import FIRST_TRAINING_SEED, seeded_episodes


def write_frames(name: str, folder: Path, episodes: int) -> int:
    """Run a policy of this package on clean frames; return the number of frames written."""
    module = import_module(f"tools.third_party.{name}")
    world = module.make_world()
    policy = mitigate.as_policy(
        module.load_policy(), world, forward=getattr(module, "forward", None)
    )
    count = 0
    for episode in seeded_episodes(range(FIRST_TRAINING_SEED, FIRST_TRAINING_SEED + episodes)):
        scene = folder / f"episode-{episode.episode_id}"
        make_folder(scene)
        observation = world.reset(episode)
        policy.reset(episode.instruction.text)
        while not world.done:
            _, encoded = cv2.imencode(".png", observation[RGB][..., ::-1])
            write_bytes(scene / f"{count:06d}.png", encoded.tobytes())
            count += 1
            observation = world.step(policy.act(observation))
    return count


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("policy", help="a module of tools/third_party")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--episodes", type=int, default=100)
    options = parser.parse_args()
    count = write_frames(options.policy, options.out, options.episodes)
    print(f"{options.out}: {count} frames of {options.episodes} episodes")


if __name__ == "__main__":
    main()
