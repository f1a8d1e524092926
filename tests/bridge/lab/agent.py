"""An agent's program (Python 3.6 to 3.13) for the fake habitat-lab; it does not import mitigate.

usage: agent.py OUT [--workers N] [--start METHOD] [--cameras N] [--steps N] ...
"""

import argparse
import hashlib
import json
import multiprocessing
import os
import signal
import time

import habitat
from habitat.core.env import Env, make_dataset


def walk(out, worker, options):
    """Run this worker's episodes and write the observations to a separate file."""
    dataset = make_dataset(options["episodes"], [4, 5, 6] if options["tokens"] else None)
    dataset.episodes = dataset.episodes[worker :: max(1, options["workers"])]
    env, seen = Env(config={"cameras": options["cameras"]}, dataset=dataset), []
    for _ in range(env.number_of_episodes):
        observations = env.reset()
        note(seen, env, observations)
        env.render()
        for step in range(options["steps"]):
            if options["die_at"] == step and options["die_worker"] in (-1, worker):
                os.kill(os.getpid(), signal.SIGKILL)
            time.sleep(options["pause"])
            last = step == options["steps"] - 1
            action = (3 if options["no_stop"] else 0) if last else 1
            observations = env.step(action)
            note(seen, env, observations)
        if options["teleport"]:
            note(seen, env, env.sim.get_observations_at([1.0, 0.0, 2.0], 0.5))
    env.close()
    with open(f"{out}.{worker}", "w") as file:
        json.dump(seen, file)


def note(seen, env, observations):
    frames = {n: o for n, o in observations.items() if n != "instruction"}
    for name, frame in frames.items():
        assert frame.flags.writeable or name == "goal"
    seen.append(
        {
            "episode": str(env.current_episode.episode_id),
            "names": list(observations),
            "words": observations.get("instruction"),
            "frames": {n: hashlib.sha256(f.tobytes()).hexdigest() for n, f in frames.items()},
            "owned": {n: bool(f.flags.owndata and f.flags.c_contiguous) for n, f in frames.items()},
        }
    )


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out")
    parser.add_argument("--workers", type=int, default=0)
    parser.add_argument("--start", default="fork")
    parser.add_argument("--cameras", type=int, default=1)
    parser.add_argument("--steps", type=int, default=3)
    parser.add_argument("--episodes", type=int, default=4)
    parser.add_argument("--die-at", type=int, default=-1)
    parser.add_argument("--die-worker", type=int, default=-1)
    parser.add_argument("--pause", type=float, default=0.0)
    parser.add_argument("--wait", type=float, default=0.0, help="seconds at the end")
    for flag in ("--tokens", "--no-stop", "--teleport"):
        parser.add_argument(flag, action="store_true")
    value = parser.parse_args()
    options = vars(value)
    assert habitat.Env is Env
    if not value.workers:
        walk(value.out, 0, options)
    else:
        context = multiprocessing.get_context(value.start)
        processes = [
            context.Process(target=walk, args=(value.out, i, options), daemon=True)
            for i in range(value.workers)
        ]
        for process in processes:
            process.start()
        for process in processes:
            process.join()
    time.sleep(value.wait)


if __name__ == "__main__":
    main()
