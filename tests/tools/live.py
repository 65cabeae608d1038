# SPDX-License-Identifier: MIT
"""live.py WHAT PORT [COUNT]: someone at a port of gicrun --live, for tests/system/test_live.sh. Packets are written here by
the page, models/LIVE.md section 2, and by no code of gicrun."""
import random
import socket
import struct
import sys

HEAD = "<4sHHQQQII"
SIZE = struct.calcsize(HEAD)


class Peer:
    """A socket; a number that it has used."""

    def __init__(self, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))
        self.socket.settimeout(20)
        self.number = 0
        self.socket.send(struct.pack(HEAD, b"gicA", 1, 0, 0, 0, 0, 0, 0))
        text = self.next(b"gicN")[1]
        self.hash = 0xcbf29ce484222325
        for byte in text:
            self.hash = (self.hash ^ byte) * 0x100000001b3 & (1 << 64) - 1
        lines = [line.split() for line in text.decode().splitlines()]
        self.inputs = [line[1] for line in lines if line[0] == "input"]
        self.begin = [float(line[3]) for line in lines if line[0] == "input"]
        self.outputs = [line[1] for line in lines if line[0] == "output"]
        assert self.outputs[0] == "time" and len(set(self.inputs)) == len(self.inputs)

    def next(self, kind):
        """Head and the rest of the next packet of a kind."""
        while True:
            packet = self.socket.recv(65507)
            head = struct.unpack_from(HEAD, packet)
            assert head[1] == 1
            if head[0] == kind:
                assert len(packet) == SIZE + (head[6] if kind == b"gicN" else 8 * head[6])
                return head, packet[SIZE:]

    def outputs_now(self):
        head, rest = self.next(b"gicO")
        assert head[4] == self.hash and head[6] == len(self.outputs)
        return head, dict(zip(self.outputs, struct.unpack(f"<{head[6]}d", rest)))

    def packet(self, values, flags=0, number=None, kind=b"gicI", version=1, names=None, count=None):
        if number is None:
            self.number += 1
            number = self.number
        return struct.pack(HEAD, kind, version, flags, number, self.hash if names is None else names, 0,
                           len(values) if count is None else count, 0) + struct.pack(f"<{len(values)}d", *values)

    def send(self, values, flags=0):
        self.socket.send(self.packet(values, flags))

    def until_taken(self):
        """Outputs of the first step that has the last packet."""
        while True:
            head, values = self.outputs_now()
            if head[5] == self.number:
                return head, values


def drive(port):
    peer = Peer(port)
    values = list(peer.begin)
    assert not peer.outputs_now()[0][2] & 1
    place = {name: i for i, name in enumerate(peer.inputs)}
    values[place["accelerator"]] = 0.3
    values[place["rack"]] = 0.01
    peer.send(values)
    head, _ = peer.until_taken()
    assert head[2] & 1, "it says that packets drive"
    for i in range(40):  # the same again, and others
        values[place["brake"]] = 0.001 * (i // 2)
        peer.send(values)
        peer.outputs_now()
    rack = 0.01
    for i in range(40):  # with rate and acceleration
        values[place["rack"]], values[place["rack.rate"]] = rack, -0.02
        rack -= 0.02 * 0.012
        peer.send(values, 2)
        peer.outputs_now()
    peer.send(values, 1)
    head, _ = peer.until_taken()
    assert not head[2] & 1, "given back"


def wrong(port):
    peer, other = Peer(port), Peer(port)
    good = list(peer.begin)
    n = len(good)
    rack = peer.inputs.index("rack")
    peer.send(good)
    peer.until_taken()

    def change(i, value):
        values = list(good)
        values[i] = value
        return peer.packet(values)

    whole = peer.packet(good)
    bad = [whole[:-1], whole + b"\0", peer.packet(good, count=n + 1),  # size
           peer.packet(good, kind=b"gicX"), peer.packet(good, version=2), b"",  # kind; nothing at all: size
           peer.packet(good, kind=b"gicO"),
           peer.packet(good, names=peer.hash ^ 1), peer.packet(good, flags=4),
           change(0, float("nan")), change(n - 1, float("inf")), change(n - 1, float("-inf")),
           change(rack, 10.0), change(rack, -10.0),
           peer.packet(good, number=1), peer.packet(good, number=0)]
    bad.remove(b"")
    for i, packet in enumerate(bad):
        peer.socket.send(packet)
        while peer.outputs_now()[0][7] < i + 1:  # it is counted
            pass
        assert peer.outputs_now()[0][5] == 1, "and not used"
    other.send(good)
    while other.outputs_now()[0][7] < len(bad) + 1:
        pass
    assert other.outputs_now()[0][5] == 1


def fuzz(port, count):
    peer = Peer(port)
    chance = random.Random(7)
    template = bytearray(peer.packet(peer.begin))
    for i in range(count):
        if i % 3 == 0:
            packet = chance.randbytes(65507 if i % 200 == 0 else chance.choice([0, 1, 39, 40, 41, 88, 1000]))
        elif i % 3 == 1:  # a good one with the hash spoiled, and more
            packet = bytearray(template)
            packet[16 + chance.randrange(8)] ^= 1 + chance.randrange(255)
            for _ in range(chance.randrange(6)):
                at = chance.randrange(len(packet))
                if not 16 <= at < 24:
                    packet[at] = chance.randrange(256)
        else:  # a good one, cut or lengthened
            size = chance.randrange(len(template))
            packet = template[:size] if chance.random() < 0.5 else template + chance.randbytes(size + 1)
        peer.socket.send(bytes(packet))
        if i % 20 in (0, 19):  # no faster than it looks
            peer.socket.send(struct.pack(HEAD, b"gicA", 1, 0, 0, 0, 0, 0, 0))
            peer.next(b"gicN")
    head, _ = peer.outputs_now()
    assert head[5] == 0 and not head[2] & 1
    assert head[7] > 0.99 * count, f"{head[7]} of {count} were counted"


def leave(port):
    first, second = Peer(port), Peer(port)
    second.number = 100  # echoes tell them apart
    first.send(first.begin)
    first.until_taken()
    while first.outputs_now()[0][2] & 1:
        pass
    second.send(second.begin)
    assert second.until_taken()[0][2] & 1
    second.send(second.begin, 1)
    second.until_taken()


if __name__ == "__main__":
    {"drive": drive, "wrong": wrong, "fuzz": fuzz, "leave": leave}[sys.argv[1]](*map(int, sys.argv[2:]))
