#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""live_client.py PORT [SECONDS]: the pedals of a vehicle of `gicrun --live PORT` (models/LIVE.md), which keep 8 m/s for
some seconds and are given back then. Python's own modules do."""
import socket
import struct
import sys
import time

HEAD = struct.Struct("<4sHHQQQII")  # kind, version, flags, number, hash, echo, count, dropped
BACK, EXACT = 1, 2
HELD, OVER, MISSED = 1, 2, 4
VERSION = 1


def fnv(text):
    """The hash of the names: FNV-1a of 64 bits."""
    value = 14695981039346656037
    for byte in text:
        value = (value ^ byte) * 1099511628211 % 2**64
    return value


class Vehicle:
    """A vehicle at a port: `inputs` and `outputs` are names, in the order of packets; `units` has theirs, and `begin`
    the values of inputs at time 0."""

    def __init__(self, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))
        self.socket.settimeout(0.5)
        self.inputs, self.outputs, self.units, self.begin, self.number = [], [], {}, {}, 0
        text = self._ask()
        self.hash = fnv(text)
        for line in text.decode().splitlines():
            kind, name, *rest = line.split(" ", 2)
            if kind in ("input", "output"):
                unit, _, value = rest[0][1:].partition("]")
                getattr(self, kind + "s").append(name)
                self.units[name] = unit
                if value:
                    self.begin[name] = float(value)
            else:
                setattr(self, kind, name if kind == "model" else float(name))

    def _ask(self):
        for _ in range(120):  # it may not be there yet, or still compile
            try:
                self.socket.send(HEAD.pack(b"gicA", VERSION, 0, 0, 0, 0, 0, 0))
                packet = self.socket.recv(65507)
            except ConnectionRefusedError:
                time.sleep(0.5)
                continue
            except TimeoutError:
                continue
            if packet[:4] == b"gicN":
                return packet[HEAD.size:]
        raise SystemExit("live_client: nobody answers there")

    def send(self, values, flags=0):
        """Inputs, {name: value}; all of them. flags: BACK gives them back to the scene; EXACT: rates and accelerations
        of driven coordinates, `name.rate` and `name.acceleration`, are meant as well."""
        self.number += 1
        head = HEAD.pack(b"gicI", VERSION, flags, self.number, self.hash, 0, len(self.inputs), 0)
        self.socket.send(head + struct.pack(f"<{len(self.inputs)}d", *(values[name] for name in self.inputs)))

    def receive(self):
        """The next outputs, {name: value}, with `flags`, `step` and `echo`; None: the run is over, or nothing came."""
        try:
            packet = self.socket.recv(65507)
        except (ConnectionRefusedError, TimeoutError):
            return None
        kind, version, flags, step, names, echo, count, _ = HEAD.unpack_from(packet)
        if kind == b"gicN":
            return self.receive()
        if kind != b"gicO" or version != VERSION or names != self.hash or flags & OVER:
            return None
        values = dict(zip(self.outputs, struct.unpack_from(f"<{count}d", packet, HEAD.size)))
        return values | {"flags": flags, "step": step, "echo": echo}


def main():
    vehicle = Vehicle(int(sys.argv[1]))
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 5
    inputs, begin, before, speed = dict(vehicle.begin), None, None, None
    while (now := vehicle.receive()) and (begin is None or now["time"] < begin + seconds):
        begin = now["time"] if begin is None else begin
        if before and now["time"] > before["time"]:
            way = ((now["chassis.x"] - before["chassis.x"]) ** 2 + (now["chassis.y"] - before["chassis.y"]) ** 2) ** 0.5
            speed = way / (now["time"] - before["time"])
            inputs["accelerator"] = min(max(0.3 * (8 - speed), 0), 1)
            inputs["brake"] = min(max(0.1 * (speed - 8.5), 0), 1)
            vehicle.send(inputs)
        before = now
    vehicle.send(inputs, BACK)
    if speed is None:
        raise SystemExit("live_client: no outputs came")
    print(f"{vehicle.model}: {speed:.2f} m/s at t = {before['time']:.3f} s")


if __name__ == "__main__":
    main()
