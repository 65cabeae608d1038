# SPDX-License-Identifier: MIT
"""libgic by ctypes: finding it, its functions, its statuses as exceptions."""
import ctypes
import os
import threading

API = 3  # GICL_VERSION of gic.h
OK, FAILED, WRONG = 0, 1, 2
ERROR, WARNING, NOTE, TEXT, PROGRESS = range(5)
STATE, RATE, INPUT, OUTPUT, PARAMETER, PORT = range(6)
Handle = ctypes.c_uint64


class Message(ctypes.Structure):
    _fields_ = [("kind", ctypes.c_int), ("file", ctypes.c_char_p), ("line", ctypes.c_int), ("column", ctypes.c_int),
                ("text", ctypes.c_char_p), ("remedy", ctypes.c_char_p), ("printed", ctypes.c_char_p)]


class Options(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("engine", ctypes.c_char_p), ("solve", ctypes.c_char_p),
                ("recovery", ctypes.c_char_p), ("compiler", ctypes.c_char_p), ("flags", ctypes.c_char_p),
                ("integrator", ctypes.c_char_p), ("tolerance", ctypes.c_double), ("general", ctypes.c_int),
                ("lanes", ctypes.c_int)]


class Study(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("kind", ctypes.c_char_p), ("scene", ctypes.c_char_p),
                ("results", ctypes.c_char_p), ("page", ctypes.c_char_p), ("plot", ctypes.c_char_p),
                ("with_", ctypes.c_char_p), ("replay", ctypes.c_char_p), ("states", ctypes.c_char_p),
                ("at", ctypes.POINTER(ctypes.c_double)), ("axle", ctypes.c_char_p), ("travel", ctypes.c_double),
                ("loads", ctypes.c_int), ("joints", ctypes.c_int), ("compare", ctypes.c_char_p), ("manoeuvre", ctypes.c_char_p),
                ("formula", ctypes.c_char_p), ("measured", ctypes.c_char_p),
                ("key", ctypes.POINTER(ctypes.c_char_p)), ("keys", ctypes.c_int), ("trace", ctypes.c_char_p),
                ("record", ctypes.c_char_p), ("inputs", ctypes.c_char_p), ("joystick", ctypes.c_char_p),
                ("axes", ctypes.c_char_p), ("port", ctypes.c_int), ("seconds", ctypes.c_double),
                ("vary", ctypes.POINTER(ctypes.c_char_p)), ("varied", ctypes.c_int), ("quiet", ctypes.c_int)]


class Sweep(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("scene", ctypes.c_char_p), ("results", ctypes.c_char_p),
                ("vary", ctypes.POINTER(ctypes.c_char_p)), ("varied", ctypes.c_int), ("latin", ctypes.c_int64),
                ("seed", ctypes.c_uint64), ("alone", ctypes.c_int), ("quiet", ctypes.c_int), ("part", ctypes.c_int),
                ("parts", ctypes.c_int), ("metric", ctypes.POINTER(ctypes.c_char_p)), ("metrics", ctypes.c_int), ("series", ctypes.c_int),
                ("sobol", ctypes.c_int64), ("report", ctypes.c_char_p), ("front", ctypes.POINTER(ctypes.c_char_p)),
                ("fronts", ctypes.c_int)]


class Array(ctypes.Structure):
    _fields_ = [("name", ctypes.c_char_p), ("rows", ctypes.c_int64), ("columns", ctypes.c_int),
                ("data", ctypes.POINTER(ctypes.c_double)), ("row_name", ctypes.POINTER(ctypes.c_char_p)),
                ("row_unit", ctypes.POINTER(ctypes.c_char_p)), ("column_name", ctypes.POINTER(ctypes.c_char_p)),
                ("column_unit", ctypes.POINTER(ctypes.c_char_p))]


class Error(Exception):
    """A mistake in a file, a model or a run. `str()` is what gicrun prints; `text` and `remedy` are parts of it, and
    `file`, `line` and `column` (from 1) where it is, or None. `warnings`: texts of warnings before it."""

    def __init__(self, said, status):
        last = said[-1] if said else {"text": f"status {status}", "printed": f"status {status}"}
        self.text = last["text"]
        self.remedy = last.get("remedy")
        self.file = last.get("file")
        self.line = last.get("line") or None
        self.column = last.get("column") or None
        self.status = status
        self.warnings = [message["printed"] for message in said[:-1] if message.get("kind") != TEXT]
        super().__init__("".join(message["printed"] for message in said if message.get("kind") != TEXT).rstrip("\n")
                         or self.text)


class WrongCall(Error, ValueError):
    """A mistake in a call: a closed thing, a wrong size, name or number."""


class RunError(Error):
    """A run, a step or an evaluation that ended early. Of Model.run(): `columns` are the rows up to there, or None."""

    columns = None


def _paths():
    """Where the library may be: named by the environment, in the package, beside an installed one, in the build folder of
    the sources."""
    here = os.path.dirname(os.path.abspath(__file__))
    named = os.environ.get("GICGEN_LIBRARY")
    if named:
        return [named]
    prefix = os.path.normpath(os.path.join(here, "..", "..", ".."))  # PREFIX/lib
    build = os.path.normpath(os.path.join(here, "..", "..", "..", "build"))
    return [os.path.join(here, "libgic.so"), os.path.join(prefix, "libgic.so.1"), os.path.join(build, "libgic.so"),
            "libgic.so.1"]


def _load():
    tried = []
    for path in _paths():
        if os.sep in path and not os.path.exists(path):
            tried.append(f"{path}: not there")
            continue
        try:
            return ctypes.CDLL(path)
        except OSError as reason:
            tried.append(f"{path}: {reason}")
    raise ImportError("gicgen: libgic is not found\n  remedy: `make install`, or set GICGEN_LIBRARY to its path\n  tried "
                      + "\n  tried ".join(tried))


_c = _load()
_c.gicl_open.restype = _c.gicl_messages_new.restype = ctypes.c_void_p
_c.gicl_release.restype = ctypes.c_char_p
_c.gicl_message_count.argtypes = [ctypes.c_void_p]
_c.gicl_message_get.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.POINTER(Message)]
_c.gicl_messages_free.argtypes = [ctypes.c_void_p]

_P = ctypes.c_void_p
_ARGUMENTS = {
    "free": [Handle],
    "model_open": [ctypes.c_char_p, _P, _P],
    "model_text": [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_size_t, _P, _P],
    "generate": [Handle, _P, _P],
    "count": [Handle, ctypes.c_int, _P],
    "signal": [Handle, ctypes.c_int, ctypes.c_int, _P, _P],
    "find": [Handle, ctypes.c_int, ctypes.c_char_p, _P],
    "instance_new": [Handle, ctypes.c_char_p, _P],
    "set_up": [Handle, _P, ctypes.c_int],
    "view": [Handle, ctypes.c_int, _P, _P],
    "restart": [Handle, ctypes.c_double],
    "time": [Handle, _P],
    "step": [Handle, ctypes.c_double, ctypes.c_int, ctypes.c_int, ctypes.c_int64],
    "rhs": [Handle, ctypes.c_double, _P, _P, ctypes.c_int],
    "outputs": [Handle],
    "snapshot_size": [Handle, _P],
    "snapshot": [Handle, _P, ctypes.c_size_t],
    "restore": [Handle, _P, ctypes.c_size_t],
    "batch_new": [Handle, ctypes.c_char_p, ctypes.c_int, ctypes.c_int, _P],
    "batch_view": [Handle, ctypes.c_int, _P, _P, _P],
    "batch_step": [Handle, ctypes.c_double, ctypes.c_int, ctypes.c_int, ctypes.c_int64, _P],
    "batch_outputs": [Handle, _P],
    "batch_reset": [Handle, _P],
    "batch_restart": [Handle, _P],
    "run": [Handle, ctypes.c_char_p, _P],
    "equilibrium": [Handle, ctypes.c_char_p, _P],
    "modes": [Handle, ctypes.c_char_p, _P],
    "linearize": [Handle, ctypes.c_char_p, ctypes.c_double, _P],
    "write": [Handle, _P],
    "sweep_run": [Handle, _P, _P],
    "array_count": [Handle, _P],
    "array_get": [Handle, ctypes.c_int, _P, ctypes.c_size_t],
}
for _name, _arguments in _ARGUMENTS.items():
    getattr(_c, "gicl_" + _name).argtypes = [_P] + _arguments + [_P]

if _c.gicl_version() != API:
    raise ImportError(f"gicgen: this package is for version {API} of libgic's interface, not {_c.gicl_version()}")

VERSION = _c.gicl_release().decode()
_library = _c.gicl_open()
if not _library:
    raise MemoryError("gicgen: no memory for the library")


class _Said(threading.local):
    """A list of messages for each thread."""

    def __init__(self):
        self.list = _c.gicl_messages_new()
        if not self.list:
            raise MemoryError

    def __del__(self):
        _c.gicl_messages_free(self.list)


_said = _Said()


def messages():
    """Those of the last call of this thread, as dictionaries."""
    message, out = Message(), []
    while _c.gicl_message_get(_said.list, len(out), ctypes.byref(message)):
        text = {name: getattr(message, name) for name, _ in Message._fields_}
        out.append({name: value.decode(errors="replace") if isinstance(value, bytes) else value
                    for name, value in text.items()})
    return out


def call(name, *arguments):
    """Call a function; a status other than OK raises an exception."""
    status = getattr(_c, "gicl_" + name)(_library, *arguments, _said.list)
    if status != OK:
        raise_status(status)


def texts(*kinds):
    """What messages of some kinds print, of the last call."""
    return [message["printed"] for message in messages() if message["kind"] in kinds]


def raise_status(status):
    """The exception of a status."""
    raise (WrongCall if status == WRONG else RunError if status < 0 else Error)(messages(), status)


# of a step of a batch, which is called often: where messages of a thread are; the function, which takes its arguments as
# batch_arguments() prepares them, since their conversion takes longer than the call
said = _said
batch_step = _c["gicl_batch_step"]


def batch_arguments(*arguments):
    return tuple(kind.from_param(value) for kind, value in
                 zip([_P] + _ARGUMENTS["batch_step"] + [_P], (_library,) + arguments, strict=True))


class Owned:
    """A handle that is closed when nobody holds it any more: views of its memory hold it too."""

    def __init__(self, handle):
        self.handle = handle

    def __reduce_ex__(self, protocol):
        raise TypeError("models and vehicles can not be copied or pickled: snapshot() and restore() take the state of a "
                        "vehicle to another instance of its model")

    def __del__(self):
        _c.gicl_free(_library, self.handle, None)
