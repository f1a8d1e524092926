"""Write a run's agent as shipped weights, rounded to float16: tools/ship.py RUN/agent FOLDER KIND

    python tools/ship.py runs/da_per_episode-s0.6-seed0-agent-recurrent/agent \
        checkpoints/recurrent/teacher recurrent

The tool writes ``model.safetensors`` with its sha256 and ``config.yaml`` to FOLDER. It prints the
agent's fingerprints before rounding (as in the rows of the run) and after rounding (as in rows of
the shipped weights).
"""

from __future__ import annotations

import sys
from pathlib import Path

from omegaconf import OmegaConf

from mitigate.agents.fingerprint import fingerprint
from mitigate.core import build, checkpoint, conf
from mitigate.core.files import atomic_text
from mitigate.evaluation.evaluate import load
from mitigate.training.plan import agent_config


def main() -> None:
    """Run from the command line."""
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    source = sys.argv[1]
    folder = Path(sys.argv[2])
    kind = sys.argv[3]
    cfg = conf.load_config("train", [f"agent={kind}"])
    node = cfg.agent
    sensors = build.maker(cfg.env.world)().sensors
    agent = load(node, source)
    file = checkpoint.save_weights(agent, folder, half=True)
    with atomic_text(folder / "config.yaml") as text:
        text.write(OmegaConf.to_yaml({"agent": agent_config(node, agent)}))
    for path in folder.iterdir():
        if path.is_file():
            path.chmod(0o644)
    shipped = load(node, str(folder))
    print(f"wrote {file}, {file.stat().st_size / 1e6:.1f} MB")
    before, after = (fingerprint(model, sensors) for model in (agent, shipped))
    print(f"fingerprint {before} before rounding, {after} after")


if __name__ == "__main__":
    main()
