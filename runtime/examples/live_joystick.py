#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""live_joystick.py PORT DEVICE NAME=KIND:LOW:HIGH ...: a joystick, wheel or gamepad of Linux (/dev/input/js0) drives a
vehicle of `gicrun --live PORT` (models/LIVE.md). KIND is `axis` or `button` with its number from 0 on, as in
`rack=axis0:0.03:-0.03`: the input goes from LOW to HIGH as the axis goes from one end to the other, or as the button is
pressed. Python's own modules do."""
import os
import re
import select
import struct
import sys

from live_client import BACK, Vehicle

EVENT = struct.Struct("<IhBB")  # linux/joystick.h: time in ms, value, type, number
KINDS = {1: "button", 2: "axis"}
FIRST = 0x80  # of a type: not a move, but how things are when the device is opened
END = 32767  # of an axis, on either side


def read_uses(words, inputs):
    """{(kind, number): [(input, low, high), ...]} of words `NAME=KIND:LOW:HIGH`."""
    uses = {}
    for word in words:
        found = re.fullmatch(r"(.+)=(axis|button)(\d+):([^:]+):([^:]+)", word)
        try:
            name, kind, number, low, high = found.groups()
            use = name, float(low), float(high)
        except (AttributeError, ValueError):
            raise SystemExit("live_joystick: write NAME=axis0:LOW:HIGH or NAME=button0:LOW:HIGH instead of "
                             f"'{word}'") from None
        if name not in inputs:
            raise SystemExit(f"live_joystick: packets give no input '{name}'; they give {', '.join(inputs)}")
        uses.setdefault((kind, int(number)), []).append(use)
    if not uses:
        raise SystemExit("live_joystick: say which axis moves which input, as in accelerator=axis5:0:1")
    return uses


class Joystick:
    """The events of a device; `gone`: it was unplugged."""

    def __init__(self, path):
        try:
            self.file = os.open(path, os.O_RDONLY)
        except OSError as reason:
            raise SystemExit(f"live_joystick: {path}: {reason.strerror}; is it plugged in, and may you read it? Users "
                             "of the group `input` may") from None
        self.rest, self.gone = b"", False

    def events(self):
        """(kind, number, share) of what has come: an axis from 0 to 1, a button 0 or 1."""
        while not self.gone and select.select([self.file], [], [], 0)[0]:
            try:
                more = os.read(self.file, 64 * EVENT.size)
            except OSError:  # ENODEV
                more = b""
            self.gone = not more
            self.rest += more
        while len(self.rest) >= EVENT.size:
            _, value, kind, number = EVENT.unpack_from(self.rest)
            self.rest = self.rest[EVENT.size:]
            name = KINDS.get(kind & ~FIRST)
            if name:
                yield name, number, (max(value, -END) + END) / (2 * END) if name == "axis" else float(value != 0)


def main():
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    vehicle = Vehicle(int(sys.argv[1]))
    uses, inputs = read_uses(sys.argv[3:], vehicle.inputs), dict(vehicle.begin)
    stick, moved = Joystick(sys.argv[2]), False
    while vehicle.receive():
        for kind, number, share in stick.events():
            for name, low, high in uses.get((kind, number), []):
                inputs[name] = low + share * (high - low)
                moved = True
        if stick.gone:
            if moved:
                vehicle.send(inputs, BACK)
            raise SystemExit(f"live_joystick: {sys.argv[2]} is gone; the scene has the inputs again")
        if moved:
            vehicle.send(inputs)


if __name__ == "__main__":
    main()
