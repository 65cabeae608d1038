# SPDX-License-Identifier: MIT
"""Vehicle models of gicgen in Python: runtime/PYTHON.md.

    import gicgen
    model = gicgen.Model("car.veh")
    columns = model.run("lane_change.scene")        # columns["time"], columns.units
    car = model.instance("lane_change.scene")
    car.inputs["rack"] = 0.01
    car.step(0.005, 100)
"""
import ctypes
import math
import operator
import os

import numpy

from . import _library
from ._arrays import Lanes, Named, Table, UnknownName, view
from ._library import Error, Handle, RunError, VERSION as __version__, WrongCall, call

__all__ = ["Batch", "Error", "Instance", "Linear", "Model", "Named", "RunError", "Table", "UnknownName",
           "WrongCall"]

_METHODS = {"ab3": 0, "rk4": 1, "ros2": 2, "ros3": 3, "imex": 4, "exp3": 5}
_KINDS = {"states": (_library.STATE, "state"), "rates": (_library.RATE, "rate"), "inputs": (_library.INPUT, "input"),
          "outputs": (_library.OUTPUT, "output"), "parameters": (_library.PARAMETER, "parameter"),
          "ports": (_library.PORT, "port")}


def _bytes(text):
    """A path, a name or a word, as the library takes it."""
    if text is None:
        return None
    encoded = os.fsencode(text)
    if b"\0" in encoded:
        raise ValueError(f"a text without NUL is wanted, not {text!r}")
    return encoded


def _method(name):
    if name not in _METHODS:
        raise ValueError(f"method: 'ab3' or 'rk4', implicit 'ros2', 'ros3' or 'imex', or 'exp3' is wanted, not {name!r}")
    return _METHODS[name]


def _number(value, what):
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{what}: a number is wanted, not {value!r}") from None
    if not math.isfinite(number):
        raise ValueError(f"{what}: a finite number is wanted, not {value!r}")
    return number


def _count(value, what, least, most):
    """A whole number within what the library's counts can have."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{what}: a whole number is wanted, not {value!r}") from None
    if not least <= number <= most:
        raise ValueError(f"{what}: a whole number from {least} to {most} is wanted, not {value!r}")
    return number


def _steps(value):
    return _count(value, "steps", 0, 2**63 - 1)


def _step(value):
    step = _number(value, "step")
    if step <= 0:
        raise ValueError(f"step: a number above 0 is wanted, not {value!r}")
    return step


def _ratio(value, method):
    ratio = _count(value, "ratio", 1, 10000)  # GIC_RATIOS of gic_runtime.h
    if ratio > 1 and method == "rk4":
        raise ValueError(f"ratio: 1 is wanted with method {method!r}, not {value!r}, as it has one rate for everything")
    return ratio


def _vector(value, count, what):
    """A contiguous copy-free array of `count` finite numbers."""
    array = numpy.ascontiguousarray(value, dtype=float)
    if array.shape != (count,):
        raise ValueError(f"{what}: shape ({count},) is wanted, not {array.shape}")
    if not numpy.isfinite(array).all():
        raise ValueError(f"{what}: finite numbers are wanted")
    return array


def _texts(pointer, count):
    return [pointer[i].decode() for i in range(count)] if pointer else None


class Model:
    """A model from a .veh file, or from `text`, in which included files are sought from the folder of `name`. Options
    are those of gicrun: engine "tcc", "cc" or "tape" (the same bits, runs of scenes with `general`; "cc" is the fastest and takes longest to begin),
    solve, recovery, compiler and its flags, integrator and tolerance instead of the scenes', general."""

    def __init__(self, path=None, *, text=None, name="model.veh", engine=None, solve=None, recovery=None, compiler=None,
                 flags=None, integrator=None, tolerance=0.0, general=False):
        if (path is None) == (text is None):
            raise TypeError("a path or a text is wanted, one of them")
        options = _library.Options(ctypes.sizeof(_library.Options), _bytes(engine), _bytes(solve), _bytes(recovery),
                                   _bytes(compiler), _bytes(flags), _bytes(integrator), tolerance, general)
        handle = Handle()
        if path is not None:
            call("model_open", _bytes(path), ctypes.byref(options), ctypes.byref(handle))
        else:
            data = text.encode()
            call("model_text", _bytes(name), data, len(data), ctypes.byref(options), ctypes.byref(handle))
        self.warnings = _library.texts(_library.WARNING, _library.NOTE)
        self._owned = _library.Owned(handle)
        self._names = {}

    def close(self):
        """Instances and batches of it go on."""
        self._owned = None

    @property
    def _handle(self):
        if self._owned is None:
            raise WrongCall([{"text": "the model is closed", "printed": "the model is closed"}], _library.WRONG)
        return self._owned.handle

    def _signals(self, kind):
        """Names and units."""
        if kind not in self._names:
            number, count = _KINDS[kind][0], ctypes.c_int()
            call("count", self._handle, number, ctypes.byref(count))
            names, units = [], []
            for i in range(count.value):
                name, unit = ctypes.c_char_p(), ctypes.c_char_p()
                call("signal", self._handle, number, i, ctypes.byref(name), ctypes.byref(unit))
                names.append(name.value.decode())
                units.append((unit.value or b"").decode())
            self._names[kind] = tuple(names), tuple(units)
        return self._names[kind]

    states = property(lambda self: self._signals("states")[0], doc="names, in the order of arrays")
    inputs = property(lambda self: self._signals("inputs")[0], doc="names, in the order of arrays")
    outputs = property(lambda self: self._signals("outputs")[0], doc="names, in the order of arrays")
    parameters = property(lambda self: self._signals("parameters")[0], doc="names of the tunable ones")
    ports = property(lambda self: self._signals("ports")[0], doc="names, in the order of arrays")

    def units(self, kind):
        """Units by name, of "states", "inputs", "outputs", "parameters" or "ports"."""
        if kind not in _KINDS:
            raise UnknownName(f"no kind {kind!r}: there are {', '.join(_KINDS)}")
        return dict(zip(*self._signals(kind)))

    def code(self):
        """The C that gicgen writes, and its header."""
        c, h = ctypes.c_char_p(), ctypes.c_char_p()
        call("generate", self._handle, ctypes.byref(c), ctypes.byref(h))
        return c.value.decode(), h.value.decode()

    def instance(self, scene=None):
        return Instance(self, scene)

    def batch(self, vehicles, scene=None, lanes=1):
        return Batch(self, vehicles, scene, lanes)

    def _result(self, name, *arguments):
        """Arrays of a result by name: data, names and units of rows, of columns; and the exception that ended it."""
        handle, failure, arrays = Handle(), None, {}
        try:
            call(name, self._handle, *arguments, ctypes.byref(handle))
            self.warnings = _library.texts(_library.WARNING, _library.NOTE)
        except Error as error:
            if not handle:
                raise
            failure = error
        owned, count = _library.Owned(handle), ctypes.c_int()
        call("array_count", handle, ctypes.byref(count))
        for i in range(count.value):
            a = _library.Array()
            call("array_get", handle, i, ctypes.byref(a), ctypes.sizeof(a))
            shape = (a.rows, a.columns)
            data = view(owned, ctypes.cast(a.data, ctypes.c_void_p).value, shape, (8 * a.columns, 8), True)
            data.flags.writeable = False
            arrays[a.name.decode()] = (data, _texts(a.row_name, a.rows), _texts(a.row_unit, a.rows),
                                       _texts(a.column_name, a.columns), _texts(a.column_unit, a.columns))
        return arrays, failure

    def run(self, scene):
        """A scene from begin to end: columns with the bits of gicrun's results. If it ends early, RunError has the rows
        up to there."""
        arrays, failure = self._result("run", _bytes(scene))
        data, _, _, names, units = arrays["columns"]
        columns = Table(data, names, units)
        if failure:
            ended = RunError(_library.messages() or [], failure.status)
            ended.__dict__.update(failure.__dict__)
            ended.args = failure.args
            ended.columns = columns
            raise ended
        return columns

    def equilibrium(self, scene=None):
        """Static equilibrium near the initial state of a scene or of the model: `.states`, `.inputs`, `.outputs`."""
        arrays, _ = self._result("equilibrium", _bytes(scene))
        return Equilibrium(arrays)

    def modes(self, scene=None):
        """Small motions about it: a table with columns real, imaginary, frequency, damping, time_constant and shares; a
        row each, NaN where a number does not apply."""
        data, _, _, names, units = self._result("modes", _bytes(scene))[0]["modes"]
        return Table(data, names, units)

    def linearize(self, scene=None, at=None):
        """The linear model about the equilibrium, or about the time `at` (s) of the run of the scene."""
        if at is not None and scene is None:
            raise TypeError("at: a time of a scene's run, and no scene is given")
        time = math.nan if at is None else _number(at, "at")
        return Linear(self._result("linearize", _bytes(scene), time)[0])

    def sweep(self, scene, vary, results, *, latin=0, seed=1, alone=False, metrics=None, series=False):
        """A scene with many values, as gicsweep: vary is {name: (low, high, count)}, or {name: (low, high)} with `latin`
        runs of a Latin hypercube. A table with a row for each run, which is written to the file `results` too; beside that
        finished runs are kept, so that the same call goes on after an interrupt. alone: each run by itself, by the model's
        engine. metrics: {name: "rms(chassis.z)"}, further columns. A file whose name ends in .h5 is HDF5; series: with the
        scene's outputs over time."""
        metric = [_bytes(f"{name}={value}") for name, value in (metrics or {}).items()]
        words = [_bytes(f"{name}=" + ":".join(repr(_number(value, name)) if i < 2 else str(_count(value, name, 1, 10**7))
                                              for i, value in enumerate(values)))
                 for name, values in vary.items()]
        sweep = _library.Sweep(ctypes.sizeof(_library.Sweep), _bytes(scene), _bytes(results),
                               (ctypes.c_char_p * (len(words) + 1))(*words), len(words), _count(latin, "latin", 0, 10**7),
                               _count(seed, "seed", 0, 2**63 - 1), bool(alone), True, 0, 0,
                               (ctypes.c_char_p * (len(metric) + 1))(*metric), len(metric),
                               bool(series))
        data, _, _, names, units = self._result("sweep_run", ctypes.byref(sweep))[0]["runs"]
        return Table(data, names, units)

    def write(self, kind, scene=None, *, results=None, page=None, plot=None, with_=None, replay=None, states=None, at=None,
              axle=None, travel=0.0, loads=False, joints=False, compare=None, manoeuvre=None, keys=None, trace=None, formula=None,
              measured=None, record=None, inputs=None, joystick=None, axes=None, port=0, seconds=0.0, vary=None):
        """What gicrun writes: files, and the text that it prints, which is returned. kind: "run", "drive", "eval",
        "equilibrium", "modes", "linearize", "kc", "sheet", "manoeuvre", "trim", "gradient", "identify", "optimize" or
        "live"; others are gicrun's options (page: of --animate, --drive or --report; formula: of --gradient and --optimize; measured: of --identify; port: of
        --live, which needs `seconds`). keys: of a
        manoeuvre and of steady driving, {name: number}; of "gradient" and "identify", a list of names, of "optimize" of
        words name=low:high. vary: of "kc", "sheet" and
        "manoeuvre", {name: (low, high, count)}."""
        words = ([_bytes(f"{name}=" + (value if isinstance(value, str) else repr(_number(value, name))))
                  for name, value in keys.items()] if isinstance(keys, dict) else [_bytes(name) for name in keys or ()])
        time = None if at is None else ctypes.pointer(ctypes.c_double(_number(at, "at")))
        grid = [_bytes(f"{name}={_number(low, name)!r}:{_number(high, name)!r}:{int(count)}")
                for name, (low, high, count) in (vary or {}).items()]
        study = _library.Study(ctypes.sizeof(_library.Study), _bytes(kind), _bytes(scene), _bytes(results), _bytes(page),
                               _bytes(plot), _bytes(with_), _bytes(replay), _bytes(states), time, _bytes(axle),
                               _number(travel, "travel"), bool(loads), bool(joints), _bytes(compare), _bytes(manoeuvre), _bytes(formula),
                               _bytes(measured),
                               (ctypes.c_char_p * (len(words) + 1))(*words), len(words), _bytes(trace),
                               _bytes(record), _bytes(inputs), _bytes(joystick), _bytes(axes), _count(port, "port", 0, 65535), _number(seconds, "seconds"),
                               (ctypes.c_char_p * (len(grid) + 1))(*grid), len(grid), True)
        call("write", self._handle, ctypes.byref(study))
        self.warnings = _library.texts(_library.WARNING, _library.NOTE)
        return "".join(_library.texts(_library.TEXT))

    def __repr__(self):
        return "<gicgen.Model>"


class Equilibrium:
    """States, inputs and outputs at rest, by name; read only."""

    def __init__(self, arrays):
        for name in ("state", "input", "output"):
            data, _, _, names, units = arrays[name]
            setattr(self, name + "s", Named(data[0], names, units, name))


class Linear:
    """dz/dt = f + A z + B u + E p, y = y0 + C z + D u + F p, of changes z, u, p; N: neutral directions. Names of z, u, y,
    p are `states`, `inputs`, `outputs`, `parameters`. `control.ss(*linear.matrices, **linear.labels)` is the same for
    python-control."""

    def __init__(self, arrays):
        for name, (data, *_) in arrays.items():
            setattr(self, name, data[:, 0] if name in ("f", "z0", "u0", "y0", "p0") else data)
        self.time = float(self.time[0, 0])
        self.states, self.state_units = tuple(arrays["A"][3]), tuple(arrays["A"][4])
        self.inputs, self.input_units = tuple(arrays["B"][3]), tuple(arrays["B"][4])
        self.outputs, self.output_units = tuple(arrays["C"][1]), tuple(arrays["C"][2])
        self.parameters, self.parameter_units = tuple(arrays["E"][3]), tuple(arrays["E"][4])

    @property
    def matrices(self):
        return self.A, self.B, self.C, self.D

    @property
    def labels(self):
        return {"states": list(self.states), "inputs": list(self.inputs), "outputs": list(self.outputs)}


class Instance:
    """One vehicle: `states`, `rates`, `inputs`, `outputs`, `parameters`, `ports` are views of its memory, by name.

    A scene gives the road, the initial state, parameters, and the inputs at time 0, which then are yours. Setting states
    by name or place forgets the integrator's history; who writes into `states.array` calls restart()."""

    def __init__(self, model, scene=None):
        handle = Handle()
        call("instance_new", model._handle, _bytes(scene), ctypes.byref(handle))
        self._owned = _library.Owned(handle)
        self._views = {}
        for name, (kind, word) in _KINDS.items():
            data, count = ctypes.c_void_p(), ctypes.c_int()
            call("view", handle, kind, ctypes.byref(data), ctypes.byref(count))
            names, units = model._signals(name)
            array = view(self._owned, data.value, (count.value,), (8,), name != "outputs")
            self._views[name] = Named(array, names, units, word, self.restart if name == "states" else None)

    def close(self):
        """Arrays taken from it stay valid."""
        self._owned = None
        self._views = {}

    @property
    def _handle(self):
        if self._owned is None:
            raise WrongCall([{"text": "the instance is closed", "printed": "the instance is closed"}], _library.WRONG)
        return self._owned.handle

    def _view(self, name):
        return self._views[name] if self._handle else None

    states = property(lambda self: self._view("states"))
    rates = property(lambda self: self._view("rates"))
    inputs = property(lambda self: self._view("inputs"))
    parameters = property(lambda self: self._view("parameters"))
    ports = property(lambda self: self._view("ports"))

    @property
    def outputs(self):
        """Computed when asked for, at the present state."""
        call("outputs", self._handle)
        return self._view("outputs")

    @property
    def time(self):
        time = ctypes.c_double()
        call("time", self._handle, ctypes.byref(time))
        return time.value

    def restart(self, time=None):
        """Forget the integrator's history; `time`: the time from now on, s."""
        call("restart", self._handle, self.time if time is None else _number(time, "time"))

    def set_up(self, parameters=None):
        """Back to the start, at time 0, with parameters: a dictionary of changes, or all of them."""
        if parameters is None:
            call("set_up", self._handle, None, 0)
            return
        own = self.parameters
        if isinstance(parameters, dict):
            values = own.array.copy()
            changed = Named(values, own.names, own.units, own.kind)
            for name, value in parameters.items():
                changed[name] = value
        else:
            values = _vector(parameters, len(own), "parameters")
        call("set_up", self._handle, values.ctypes.data, len(values))

    def step(self, step, steps=1, method="ab3", ratio=1):
        """`steps` steps of `step` seconds, inputs constant; ratio: fast steps of wheels and powertrain in each, not of
        'rk4'. method: 'ab3' or 'rk4'; 'ros2', 'ros3', 'imex' or 'exp3' of a model that was opened with it as
        integrator."""
        call("step", self._handle, _step(step), _method(method), _ratio(ratio, method), _steps(steps))

    def rhs(self, time, states):
        """Rates of states, with the present inputs: a right-hand side for scipy.integrate.solve_ivp."""
        count = len(self._views["states"]) if self._handle else 0
        values, rates = _vector(states, count, "states"), numpy.empty(count)
        call("rhs", self._handle, _number(time, "time"), values.ctypes.data, rates.ctypes.data, count)
        return rates

    def snapshot(self):
        """All of the vehicle but its road, as bytes."""
        size = ctypes.c_size_t()
        call("snapshot_size", self._handle, ctypes.byref(size))
        out = ctypes.create_string_buffer(size.value)
        call("snapshot", self._handle, out, size.value)
        return out.raw

    def restore(self, snapshot):
        if not isinstance(snapshot, (bytes, bytearray, memoryview)):
            raise TypeError(f"snapshot: bytes as snapshot() gives them are wanted, not {type(snapshot).__name__}")
        call("restore", self._handle, bytes(snapshot), len(snapshot))


class Batch:
    """Many vehicles, each with the bits that it has alone. The arrays of `states`, `inputs` and so on are
    [vehicles, numbers]; `status` has the status of each after the last call, 0: good.

    lanes: 2, 4, 8 or 16: as many make their steps at once, by code of the C compiler for the processor's vectors, which
    the first such batch waits for and gicrun's cache keeps. `.array` is then [blocks,
    lanes, numbers], with vehicle v at [v // lanes, v % lanes]; reading by name or place gives copies, [vehicles,
    numbers]."""

    def __init__(self, model, vehicles, scene=None, lanes=1):
        handle = Handle()
        vehicles, lanes = _count(vehicles, "vehicles", 1, 2**24), _count(lanes, "lanes", 1, 16)
        call("batch_new", model._handle, _bytes(scene), vehicles, lanes, ctypes.byref(handle))
        self._owned, self.vehicles = _library.Owned(handle), vehicles
        self.status = numpy.zeros(vehicles, dtype=numpy.int32)
        self._prepared = (None,) * 6
        self._views = {}
        for name, (kind, word) in _KINDS.items():
            data, count, stride = ctypes.c_void_p(), ctypes.c_int(), ctypes.c_size_t()
            call("batch_view", handle, kind, ctypes.byref(data), ctypes.byref(count), ctypes.byref(stride))
            names, units = model._signals(name)
            changed = self.restart if name == "states" else None
            if lanes == 1:
                array = view(self._owned, data.value, (vehicles, count.value), (8 * stride.value, 8),
                             name != "outputs")
                self._views[name] = Named(array, names, units, word, changed)
            else:
                shape = (-(-vehicles // lanes), lanes, count.value)
                array = view(self._owned, data.value, shape, (8 * stride.value, 8, 8 * lanes), name != "outputs")
                self._views[name] = Lanes(array, names, units, word, changed, vehicles)

    def close(self):
        """Arrays taken from it stay valid."""
        self._prepared = (None,) * 6
        Instance.close(self)

    _handle = Instance._handle
    _view = Instance._view
    states, rates, inputs = Instance.states, Instance.rates, Instance.inputs
    parameters, ports = Instance.parameters, Instance.ports

    def __len__(self):
        return self.vehicles

    def _which(self, which):
        """A mask as bytes; None: all."""
        if which is None:
            return None
        mask = numpy.ascontiguousarray(which, dtype=numpy.uint8)
        if mask.shape != (self.vehicles,):
            raise ValueError(f"which: shape ({self.vehicles},) is wanted, not {mask.shape}")
        return mask

    def step(self, step, steps=1, method="ab3", ratio=1, check=True):
        """Steps of all. A vehicle that fails keeps its last state and disturbs no other; then RunError is raised about the
        first, or with check=False nothing: see `status`."""
        # short, since between two steps of many vehicles the processor has forgotten all of it: what the step before
        # had is taken again
        a = self._prepared
        if not (step == a[0] and steps is a[1] and method is a[2] and ratio is a[3] and _library.said.list is a[4]):
            a = self._prepare(step, steps, method, ratio)
        status = _library.batch_step(*a[5])
        if status and (check or status > 0):
            _library.raise_status(status)

    def _prepare(self, step, steps, method, ratio):
        """Checked arguments of the library's step, after those that they are made from."""
        said, number = _library.said.list, _step(step)
        arguments = _library.batch_arguments(self._handle, number, _method(method), _ratio(ratio, method), _steps(steps),
                                             self.status.ctypes.data, said)
        self._prepared = number, steps, method, ratio, said, arguments
        return self._prepared

    def _checked(self, name, check, *arguments):
        try:
            call(name, self._handle, *arguments)
        except RunError:
            if check:
                raise

    @property
    def outputs(self):
        """Computed when asked for; those of a vehicle that has none stay as they were."""
        self.look()
        return self._view("outputs")

    def look(self, check=False):
        """Compute the outputs; `status` says of which vehicles."""
        self._checked("batch_outputs", check, self.status.ctypes.data)

    def reset(self, which=None):
        """Back to the start, at time 0, with the present parameters: all, or where the mask is not 0."""
        mask = self._which(which)
        call("batch_reset", self._handle, None if mask is None else mask.ctypes.data)
        self.status[slice(None) if mask is None else mask != 0] = 0

    def restart(self, which=None):
        """Forget the integrator's history, after states have changed."""
        mask = self._which(which)
        call("batch_restart", self._handle, None if mask is None else mask.ctypes.data)
