"""Train and load policies of stable-baselines3."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from safetensors.torch import load_model, save_model
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import EvalCallback, StopTrainingOnRewardThreshold
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.vec_env import VecNormalize, VecTransposeImage

WEIGHTS = Path(__file__).parent / "weights"
FEATURES = {"MultiInputPolicy": {"cnn_output_dim": 64}, "CnnPolicy": {"features_dim": 128}}


def load_ppo(make, path: Path, policy: str = "MultiInputPolicy") -> PPO:
    """Return the model whose weights :func:`train_ppo` saved."""
    options = {"features_extractor_kwargs": FEATURES[policy]}
    model = PPO(policy, make(), policy_kwargs=options, device="cpu")
    model.get_env().close()
    load_model(model.policy, path)
    return model


def train_ppo(
    make,
    path: Path,
    steps: int,
    policy: str = "MultiInputPolicy",
    target: float = np.inf,
    ent_coef: float = 0.01,
) -> None:
    """Train a policy with PPO until the mean return of its most probable actions reaches
    ``target``; save its weights.
    """
    envs = VecNormalize(make_vec_env(make, n_envs=8, seed=100_000), norm_obs=False)
    test_env = VecNormalize(
        make_vec_env(make, seed=200_000), training=False, norm_obs=False, norm_reward=False
    )
    # PPO also applies this wrapper to its training environments
    test_env = VecTransposeImage(test_env)
    stop = EvalCallback(
        test_env,
        callback_on_new_best=StopTrainingOnRewardThreshold(target, verbose=1),
        n_eval_episodes=20,
        eval_freq=512,  # number of steps in each training environment between two tests
    )
    model = PPO(
        policy,
        envs,
        learning_rate=5e-4,
        n_steps=128,
        batch_size=256,
        n_epochs=3,
        ent_coef=ent_coef,
        policy_kwargs={"features_extractor_kwargs": FEATURES[policy]},
        seed=0,
        verbose=1,
        device="cpu",
    )
    started = time.time()
    model.learn(steps, log_interval=5, callback=stop)
    print(f"{path.name}: {model.num_timesteps} steps in {time.time() - started:.0f} s", flush=True)
    path.parent.mkdir(exist_ok=True)
    save_model(model.policy, str(path))
    envs.close()
    test_env.close()
