# SPDX-License-Identifier: MIT
"""A small policy that keeps a lane, found by random search in many vehicles at once."""
import numpy

import gicgen
from gicgen.env import VectorEnv

VEHICLES, ACTIONS = 16, 60


def reward(seen, action):
    """Within the lane, straight ahead, and not too busy."""
    return 1 - seen[:, 0] ** 2 - 0.2 * seen[:, 1] ** 2 - 0.01 * (action[:, 0] / 0.03) ** 2


model = gicgen.Model("models/hmmwv_tires.veh")
env = VectorEnv(model, VEHICLES, scene="models/scenes/tires_coast.scene", actions={"rack": (-0.03, 0.03)},
                observations=["chassis.y", "chassis_attitude.yaw", "chassis_angular_velocity.z"], reward=reward,
                terminated=lambda seen, action: abs(seen[:, 0]) > 3, step=0.004, ratio=4, substeps=10, horizon=ACTIONS,
                scatter={"r.y": 1.0, "omega.z": 0.1})


def score(weights):
    """The mean reward of a linear policy, from the same initial states each time."""
    seen, _ = env.reset(seed=0)
    alive, total = numpy.ones(VEHICLES), 0.0
    for _ in range(ACTIONS):
        seen, gained, terminated, truncated, _ = env.step(seen @ weights[:, None])
        total += (alive * gained).sum()
        alive = alive * ~terminated
    return total / (VEHICLES * ACTIONS)


random = numpy.random.default_rng(0)
best = numpy.zeros(3)
first = reached = score(best)
for _ in range(12):
    tried = best + random.normal(0, 0.02, 3)
    gained = score(tried)
    if gained > reached:
        best, reached = tried, gained
print(f"reward {first:.4f} without steering, {reached:.4f} with weights {best}")
assert reached > first
