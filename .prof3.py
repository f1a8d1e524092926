import time, sys, os
import numpy as np, torch
from mitigate import cli, seeding, train, precision
from mitigate.build import build, build_agent
from mitigate.workers import Workers, Batches
from mitigate.trainer import to_device


def main():
    recipe_name, stage, steps, layouts, nw = (
        sys.argv[1],
        sys.argv[2],
        int(sys.argv[3]),
        int(sys.argv[4]),
        int(sys.argv[5]),
    )
    cfg = cli.load_config(
        "train", [f"recipe={recipe_name}", f"env.layouts={layouts}"] + sys.argv[6:]
    )
    agent = build_agent(cfg.agent, weights=cfg.init, seed=0)
    seeding.seed_everything(0)
    rec = build(cfg.stages[stage].recipe, agent=agent)
    rec.train()
    dev = torch.device("cpu")
    kind = precision.choose("auto", dev)
    opt = torch.optim.AdamW([p for p in rec.parameters() if p.requires_grad], lr=1e-4)
    T = [[], []]
    with Workers(nw) as w:
        with precision.computing(kind, dev):
            rec.start()
        bs = Batches(rec, w, steps, kind, dev)
        for s in range(steps):
            seeding.seed_everything(0, s)
            a = time.perf_counter()
            b = bs.batch(s)
            m = time.perf_counter()
            with precision.computing(kind, dev):
                v = rec(b)
            opt.zero_grad(set_to_none=True)
            v["loss"].backward()
            opt.step()
            e = time.perf_counter()
            T[0].append(m - a)
            T[1].append(e - m)
    h = steps // 2
    print(
        recipe_name,
        stage,
        kind,
        "workers",
        nw,
        "batch %.3f fb %.3f" % (np.mean(T[0][h:]), np.mean(T[1][h:])),
        "first %.2f" % T[0][0],
        "loss %.5f" % float(v["loss"]),
        flush=True,
    )


if __name__ == "__main__":
    main()
