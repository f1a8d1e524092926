"""A small navigation program with its own episode loop, as an example for ``mitigate run``.

    mitigate run "conditions=[clean,foreign_object,missing_data]" -- python docs/tutorials/my_program.py

A robot drives along a corridor. A lamp at the end of the corridor is red or green. The robot must
stop within one metre of the wall if the lamp is red, and one to two metres before it if the lamp is
green. Without ``mitigate run`` the program runs without corruption.
"""

import numpy as np

try:
    import mitigate_hook  # exists only under `mitigate run`; no installation is needed
except ImportError:
    mitigate_hook = None

EPISODES = 10
STEP = 0.5  # metres


def camera(distance, lamp_is_red):
    """Return the camera frames of the robot: RGB uint8 [64, 64, 3] and depth float32 [64, 64] in
    metres."""
    rgb = np.full((64, 64, 3), 90, np.uint8)
    size = int(24 / max(distance, 1.0)) + 4
    rgb[32 - size : 32 + size, 32 - size : 32 + size] = (
        (220, 40, 40) if lamp_is_red else (40, 220, 40)
    )
    depth = np.full((64, 64), distance, np.float32)
    return rgb, depth


def stop_here(rgb, depth):
    """Return whether the robot stops; this function is the policy of the program."""
    centre = rgb[28:36, 28:36].mean(axis=(0, 1))
    lamp_is_red = centre[0] > centre[1]
    limit = 1.0 if lamp_is_red else 2.0
    return np.percentile(depth, 10) <= limit


def drive(number):
    """Drive one episode and return whether the robot stopped at the right place."""
    generator = np.random.default_rng(number)
    distance = 3.0 + STEP * generator.integers(0, 6)
    lamp_is_red = bool(generator.integers(0, 2))
    episode = None
    if mitigate_hook:
        episode = mitigate_hook.connect(
            str(number), scene="corridor", instruction="Stop at the lamp."
        )
    while True:
        rgb, depth = camera(distance, lamp_is_red)
        if episode:
            frames = episode.corrupt({"rgb": rgb, "depth": depth})
            rgb, depth = frames["rgb"], frames["depth"]
        if distance <= STEP or stop_here(rgb, depth):
            break
        distance -= STEP
    success = distance <= 1.0 if lamp_is_red else 1.0 < distance <= 2.0
    if episode:
        episode.finish(success=success)
    return success


if __name__ == "__main__":
    numbers = range(EPISODES)
    if mitigate_hook:  # `mitigate run episodes=N` may ask for fewer episodes
        numbers = [
            int(name) for _, name in mitigate_hook.wanted([("corridor", str(n)) for n in numbers])
        ]
    successes = [drive(number) for number in numbers]
    print(f"{sum(successes)} of {len(successes)} episodes succeeded.")
