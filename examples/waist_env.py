"""The walk in Gymnasium's usual loop: random corrections of the waist.

    python examples/waist_env.py [SEED]

`biped_lab:` in the environment's name imports the package that registers it.
"""

import sys

import gymnasium


def main(seed: int = 11, walks: int = 3) -> int:
    """Walk, and print how each walk ended."""
    env = gymnasium.make("biped_lab:BipedWaist-v0")
    env.action_space.seed(seed)
    for walk in range(1, walks + 1):
        _, info = env.reset(seed=seed if walk == 1 else None)
        terminated = truncated = False
        while not (terminated or truncated):
            corrections = env.action_space.sample()  # of dx and dy: 0 to 14, none is 7
            _, reward, terminated, truncated, info = env.step(corrections)
        print(f"walk {walk}: {info['end_cause']}, {info['walked_s']:.3f} s, {reward:g}")
    env.close()
    return 0


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
