# SPDX-License-Identifier: MIT
"""Vehicles as a vectorised environment in the shape of Gymnasium's VectorEnv, without depending on it."""
import numpy

from . import _count, _method, _number, _ratio, _step
from ._arrays import place


def _bounds(low, high, shape, what):
    """Two arrays of that shape; low up to high."""
    try:
        low, high = (numpy.broadcast_to(numpy.asarray(each, dtype=float), shape).copy() for each in (low, high))
    except (TypeError, ValueError):
        raise ValueError(f"{what}: numbers of shape {tuple(shape)} are wanted, not {low!r} and {high!r}") from None
    if not (low <= high).all():
        raise ValueError(f"{what}: a least and a greatest number are wanted, not {low} and {high}")
    return low, high


def _pair(pair, what):
    try:
        low, high = pair
    except (TypeError, ValueError):
        raise TypeError(f"{what}: a pair of bounds (low, high) is wanted, not {pair!r}") from None
    return _bounds(low, high, (), what)


def _by_name(value, what):
    """Names and values of a dictionary."""
    if not isinstance(value, dict):
        raise TypeError(f"{what}: a dictionary is wanted, not {value!r}")
    return value.items()


def _function(value, what):
    if not callable(value):
        raise TypeError(f"{what}: a function of observations and actions is wanted, not {value!r}")
    return value


def _each(value, count, kind, what):
    """What a function gave for the vehicles."""
    array = numpy.asarray(value)
    if array.shape != (count,):
        raise ValueError(f"{what}: shape ({count},) is wanted, not {array.shape}")
    if array.dtype.kind not in "bif":
        raise TypeError(f"{what}: numbers are wanted, not {array.dtype}")
    if not numpy.isfinite(array).all():
        raise ValueError(f"{what}: finite numbers are wanted")
    return array.astype(kind)


class Box:
    """A space of arrays between bounds."""

    def __init__(self, low, high, shape, seed=None):
        self.low, self.high = _bounds(low, high, shape, "bounds")
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
    can't go on, because a step fails, is terminated; info "failed" has the statuses. A start that the model refuses, by
    its parameters or what scatter made of its states, raises the library's message; reset() then comes first."""

    metadata = {"autoreset_mode": "SameStep"}

    def __init__(self, model, num_envs, *, scene=None, actions, observations, reward, terminated=None, step=0.005,
                 substeps=1, horizon=1000, method="ab3", ratio=1, scatter=None):
        self._step, self._substeps = _step(step), _count(substeps, "substeps", 1, 2**31 - 1)
        self._method, self._ratio = method, _ratio(ratio, method)
        _method(method)
        self.horizon = _count(horizon, "horizon", 1, 2**31 - 1)
        self._reward = _function(reward, "reward")
        self._terminated = None if terminated is None else _function(terminated, "terminated")
        if isinstance(observations, str):
            raise TypeError(f"observations: a list of names is wanted, not {observations!r}")
        self.batch = model.batch(num_envs, scene)
        self.num_envs = n = self.batch.vehicles
        self.batch.step(self._step, 0, method, ratio)  # no step: can the model's code take this method?
        each = {self._place("inputs", name): _pair(pair, f"action {name!r}")
                for name, pair in _by_name(actions, "actions")}
        self._inputs = list(each)
        self._outputs = [self._place("outputs", name) for name in observations]
        self._scatter = []
        for name, width in _by_name(scatter or {}, "scatter"):
            if _number(width, f"scatter of {name!r}") < 0:
                raise ValueError(f"scatter of {name!r}: half a width of at least 0 is wanted, not {width!r}")
            self._scatter.append((self._place("states", name), float(width)))
        low, high = (numpy.array([pair[i] for pair in each.values()], dtype=float) for i in (0, 1))
        self.single_action_space = Box(low, high, (len(low),))
        self.single_observation_space = Box(-numpy.inf, numpy.inf, (len(self._outputs),))
        self.action_space = Box(low, high, (n, len(low)))
        self.observation_space = Box(-numpy.inf, numpy.inf, (n, len(self._outputs)))
        self._random, self._count, self._begun = None, numpy.zeros(n, dtype=int), False
        self._start = self.batch.inputs.array[:, self._inputs].copy()

    def _place(self, kind, name):
        return place(self.batch._views[kind].names, kind[:-1], name)

    def _look(self, check=False):
        self.batch.look(check)
        return self.batch._views["outputs"].array[:, self._outputs]

    def _begin(self, which):
        """New episodes where the mask is true; returns observations of all."""
        self._begun = False
        self.batch.reset(which)
        for at, column in zip(self._inputs, self._start.T):
            self.batch.inputs.array[which, at] = column[which]
        for at, width in self._scatter:
            for v in numpy.flatnonzero(which):
                self.batch._views["states"].array[v, at] += width * self._random[v].uniform(-1, 1)
        self.batch.restart(which)
        self._count[which] = 0
        seen = self._look(check=True)
        self._begun = True
        return seen

    def _seeds(self, seed):
        """One for each vehicle."""
        if seed is None or numpy.ndim(seed) == 0:
            number = None if seed is None else _count(seed, "seed", 0, 2**128 - 1)
            return numpy.random.SeedSequence(number).spawn(self.num_envs)
        if isinstance(seed, (str, bytes)) or len(seed) != self.num_envs:
            raise ValueError(f"seed: a number or {self.num_envs} of them are wanted, not {seed!r}")
        return [None if each is None else _count(each, "seed", 0, 2**128 - 1) for each in seed]

    def reset(self, *, seed=None, options=None):
        """Observations [num_envs, ...] and info. seed: a whole number from 0, of which each vehicle gets its own, or a
        list of them; None: random numbers go on, at first from the system. options: there are none."""
        if options:
            raise ValueError(f"options: this one has none, not {options!r}")
        if seed is not None or self._random is None:
            self._random = [numpy.random.default_rng(each) for each in self._seeds(seed)]
        return self._begin(numpy.ones(self.num_envs, dtype=bool)).copy(), {}

    def step(self, actions):
        """Observations, rewards, terminated, truncated, info. Actions beyond their bounds are brought to them."""
        if not self._begun:
            raise RuntimeError("reset() comes first")
        try:
            actions = numpy.asarray(actions, dtype=float)
        except (TypeError, ValueError):
            raise TypeError(f"actions: an array of numbers is wanted, not {actions!r}") from None
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
        reward = _each(self._reward(seen, actions), self.num_envs, float, "what the function reward gives")
        ended = failed != 0
        if self._terminated:
            ended |= _each(self._terminated(seen, actions), self.num_envs, bool, "what the function terminated gives")
        truncated = (self._count >= self.horizon) & ~ended
        done, info = ended | truncated, {}
        if failed.any():
            info["failed"] = failed
        if done.any():
            info["final_obs"], info["_final_obs"] = seen.copy(), done.copy()
            seen = numpy.where(done[:, None], self._begin(done), seen)
        return seen, reward, ended, truncated, info

    def close(self):
        self.batch.close()
