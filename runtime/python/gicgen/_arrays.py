# SPDX-License-Identifier: MIT
"""Arrays whose columns have names: views of an instance's memory, and results."""
import ctypes
import difflib

import numpy


def view(owner, address, shape, strides, settable):
    """An array over memory of the library that `owner` keeps; settable: may its numbers be written?"""
    if 0 in shape:
        return numpy.zeros(shape)
    size = sum((n - 1) * s for n, s in zip(shape, strides)) + 8
    memory = (ctypes.c_char * size).from_address(address)
    memory.owner = owner
    array = numpy.ndarray(shape, dtype=float, buffer=memory, strides=strides)
    array.flags.writeable = settable
    return array


class UnknownName(KeyError):
    """A name that is not there; the text has the nearest one."""

    def __str__(self):
        return self.args[0]


def place(names, kind, name):
    """The index of a name; an unknown one raises UnknownName, with the nearest name."""
    try:
        return names.index(name)
    except ValueError:
        pass
    near = difflib.get_close_matches(str(name), names, 1)
    hint = f"is '{near[0]}' meant?" if near else f"there are {', '.join(names)}" if names else "there is none"
    raise UnknownName(f"no {kind} '{name}': {hint}")


class _ByName:
    """What dict() and loops need of something that has `names`."""

    def __iter__(self):
        return iter(self.names)

    def __contains__(self, name):
        return name in self.names

    def keys(self):
        return self.names

    def items(self):
        return [(name, self[name]) for name in self.names]


class Named(_ByName):
    """Numbers by name, `inputs["rack"]`, or by place, `inputs[0]`, `inputs[:]`. The last axis of `array` has the names;
    of a batch the first is that of vehicles. Values that are set must be finite and fit."""

    def __init__(self, array, names, units, kind, changed=None):
        self.array, self.names, self.units, self.kind = array, tuple(names), tuple(units), kind
        self._changed = changed

    def _place(self, key):
        if isinstance(key, str):
            return (Ellipsis, place(self.names, self.kind, key))
        if isinstance(key, (list, tuple)) and key and all(isinstance(name, str) for name in key):
            return (Ellipsis, [place(self.names, self.kind, name) for name in key])
        return key

    def __getitem__(self, key):
        found = self.array[self._place(key)]
        return found if numpy.ndim(found) else float(found)

    def _check_settable(self):
        if not self.array.flags.writeable:
            raise ValueError(f"{self.kind}s are computed: they can not be set")

    def __setitem__(self, key, value):
        self._check_settable()
        at = self._place(key)
        try:
            number = numpy.asarray(value, dtype=float)
        except (TypeError, ValueError):
            raise TypeError(f"{self.kind} {key!r}: a number or an array of numbers is wanted, not {value!r}") from None
        if not numpy.isfinite(number).all():
            raise ValueError(f"{self.kind} {key!r}: finite numbers are wanted, not {value!r}")
        wanted = self.array[at].shape
        try:
            self.array[at] = number
        except ValueError:
            raise ValueError(f"{self.kind} {key!r}: shape {wanted} is wanted, not {number.shape}") from None
        if self._changed:
            self._changed()

    def __len__(self):
        return len(self.names)

    def __array__(self, dtype=None, copy=None):
        return numpy.array(self.array, dtype=dtype)

    def __repr__(self):
        return f"<{self.kind}s {dict(self.items())}>"


class Lanes(Named):
    """Numbers of vehicles in lanes: `array` is [blocks, lanes, numbers]; read are copies, [vehicles, numbers]."""

    def __init__(self, array, names, units, kind, changed, vehicles):
        super().__init__(array, names, units, kind, changed)
        self._vehicles = vehicles

    def _copy(self):
        blocks, lanes, count = self.array.shape
        return numpy.array(self.array).reshape(blocks * lanes, count)[:self._vehicles]

    def __getitem__(self, key):
        if isinstance(key, str):
            return self.array[..., place(self.names, self.kind, key)].flatten()[:self._vehicles]
        found = self._copy()[self._place(key)]
        return found if numpy.ndim(found) else float(found)

    def __setitem__(self, key, value):
        self._check_settable()
        values = Named(self._copy(), self.names, self.units, self.kind)
        values[key] = value
        blocks, lanes, count = self.array.shape
        full = self._vehicles // lanes
        self.array[:full] = values.array[:full * lanes].reshape(full, lanes, count)
        if full < blocks:
            self.array[full, :self._vehicles - full * lanes] = values.array[full * lanes:]
        if self._changed:
            self._changed()

    def __array__(self, dtype=None, copy=None):
        return self._copy().astype(dtype or float)


class Table(_ByName):
    """Columns with names and units. `table["time"]` is one; `data` all of them, [rows, columns]; `units` those by name.
    `pandas.DataFrame(dict(table))` makes a data frame of it."""

    def __init__(self, data, names, units):
        self.data, self.names, self.units = data, tuple(names), dict(zip(names, units))

    def __getitem__(self, name):
        return self.data[:, place(self.names, "column", name)]

    def __len__(self):
        return len(self.data)

    def __repr__(self):
        return f"<{len(self.data)} rows of {', '.join(self.names)}>"
