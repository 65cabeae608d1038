# SPDX-License-Identifier: MIT
"""Vehicles as a vectorised environment in the shape of Gymnasium's VectorEnv, without depending on it."""
import numpy

from ._arrays import place


class Box:
    """A space of arrays between bounds."""

    def __init__(self, low, high, shape, seed=None):
        self.low = numpy.broadcast_to(numpy.asarray(low, dtype=float), shape).copy()
        self.high = numpy.broadcast_to(numpy.asarray(high, dtype=float), shape).copy()
        self.shape, self.dtype = tuple(shape), numpy.dtype(float)
        self._random = numpy.random.default_rng(seed)

    def seed(self, seed=None):
        self._random = numpy.random.default_rng(seed)

    def sample(self):
        low, high = numpy.maximum(self.low, -1e6), numpy.minimum(self.high, 1e6)
        return self._random.uniform(low, high)

    def contains(self, x):
        x = numpy.asarray(x)
        return x.shape == self.shape and bool((x >= self.low).all() and (x <= self.high).all())


class VectorEnv:
    """`num_envs` vehicles of a batch, each in an episode of its own.

    actions: {input: (low, high)}, in the units of the inputs; observations: names of outputs. reward and terminated are
    functions of observations and actions, [num_envs, ...] each, to [num_envs]. An action holds for `substeps` steps of
    `step` seconds; an episode of `horizon` actions is truncated. scatter: {state: half width}, of the uniform random
    changes at the begin of an episode, which depend on the seed alone.

    An episode that ends begins anew at once: step() returns the first observation of the next one, and in info
    "final_obs" the last of the old one, where "_final_obs" is true (Gymnasium's autoreset mode SAME_STEP). A vehicle that
    can't go on, because a step fails, is terminated; info "failed" has the statuses."""

    metadata = {"autoreset_mode": "SameStep"}

    def __init__(self, model, num_envs, *, scene=None, actions, observations, reward, terminated=None, step=0.005,
                 substeps=1, horizon=1000, method="ab3", ratio=1, scatter=None):
        self.batch = model.batch(num_envs, scene)
        self.num_envs, self.horizon = num_envs, horizon
        self._actions, self._observations = list(actions), list(observations)
        self._inputs = [self._place("inputs", name) for name in self._actions]
        self._outputs = [self._place("outputs", name) for name in self._observations]
        self._reward, self._terminated = reward, terminated
        self._step, self._substeps, self._method, self._ratio = step, substeps, method, ratio
        self._scatter = [(self._place("states", name), width) for name, width in (scatter or {}).items()]
        low, high = (numpy.array([actions[name][i] for name in actions], dtype=float) for i in (0, 1))
        self.single_action_space = Box(low, high, (len(low),))
        self.single_observation_space = Box(-numpy.inf, numpy.inf, (len(self._outputs),))
        self.action_space = Box(low, high, (num_envs, len(low)))
        self.observation_space = Box(-numpy.inf, numpy.inf, (num_envs, len(self._outputs)))
        self._random, self._count, self._begun = None, numpy.zeros(num_envs, dtype=int), False
        self._start = self.batch.inputs.array[:, self._inputs].copy()

    def _place(self, kind, name):
        return place(self.batch._views[kind].names, kind[:-1], name)

    def _look(self):
        self.batch.look()
        return self.batch._views["outputs"].array[:, self._outputs]

    def _begin(self, which):
        """New episodes where the mask is true."""
        self.batch.reset(which)
        self.batch.inputs.array[:, self._inputs] = numpy.where(which[:, None], self._start,
                                                               self.batch.inputs.array[:, self._inputs])
        for at, width in self._scatter:
            for v in numpy.flatnonzero(which):
                self.batch._views["states"].array[v, at] += self._random[v].uniform(-width, width)
        self.batch.restart(which)
        self._count[which] = 0

    def reset(self, *, seed=None, options=None):
        """Observations [num_envs, ...] and info. seed: a number, from which each vehicle gets its own, or a list of
        them; None: random numbers go on, at first from the system."""
        if seed is not None or self._random is None:
            seeds = seed if isinstance(seed, (list, tuple)) else numpy.random.SeedSequence(seed).spawn(self.num_envs)
            if len(seeds) != self.num_envs:
                raise ValueError(f"seed: {self.num_envs} of them are wanted, not {len(seeds)}")
            self._random = [numpy.random.default_rng(each) for each in seeds]
        self._begin(numpy.ones(self.num_envs, dtype=bool))
        self._begun = True
        return self._look().copy(), {}

    def step(self, actions):
        """Observations, rewards, terminated, truncated, info. Actions beyond their bounds are brought to them."""
        if not self._begun:
            raise RuntimeError("reset() comes first")
        actions = numpy.asarray(actions, dtype=float)
        if actions.shape != self.action_space.shape:
            raise ValueError(f"actions: shape {self.action_space.shape} is wanted, not {actions.shape}")
        if not numpy.isfinite(actions).all():
            raise ValueError("actions: finite numbers are wanted")
        actions = numpy.clip(actions, self.action_space.low, self.action_space.high)
        self.batch.inputs.array[:, self._inputs] = actions
        self.batch.step(self._step, self._substeps, self._method, self._ratio, check=False)
        failed = self.batch.status.copy()
        seen = self._look().copy()
        failed = numpy.where(failed, failed, self.batch.status)
        self._count += 1
        reward = numpy.asarray(self._reward(seen, actions), dtype=float)
        ended = failed != 0
        if self._terminated:
            ended |= numpy.asarray(self._terminated(seen, actions), dtype=bool)
        truncated = (self._count >= self.horizon) & ~ended
        done, info = ended | truncated, {}
        if failed.any():
            info["failed"] = failed
        if done.any():
            info["final_obs"], info["_final_obs"] = seen.copy(), done.copy()
            self._begin(done)
            seen = numpy.where(done[:, None], self._look(), seen)
        return seen, reward, ended, truncated, info

    def close(self):
        self.batch.close()
