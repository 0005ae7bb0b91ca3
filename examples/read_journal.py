#!/usr/bin/env python3
"""Read the journal of a sweep without dmlua: python3 read_journal.py FILE

Prints what the file says of itself and a line for every member (docs/sweeps.md describes the bytes).
Only the standard library is needed."""
import struct
import sys
import zlib


def head(data):
    """The lines "key = value" of the head, and where records begin."""
    assert data[:8] == b"dmjournl", "not a journal"
    size, = struct.unpack_from("<I", data, 8)
    told, = struct.unpack_from("<I", data, 12 + size)
    assert told == zlib.crc32(data[:12 + size]), "the head is damaged"
    lines = data[12:12 + size].decode().splitlines()
    return dict(line.split(" = ", 1) for line in lines), 16 + size


def records(data, at):
    """(first member, count, bytes of the members) of every whole record; damaged ones are passed over."""
    while True:
        at = data.find(b"dmrecord", at)
        if at < 0 or at + 36 > len(data):
            return
        first, count, size = struct.unpack_from("<QQQ", data, at + 8)
        end = at + 32 + size
        if end + 4 <= len(data) and struct.unpack_from("<I", data, end)[0] == zlib.crc32(data[at:end]):
            yield first, count, data[at + 32:end]
            at = end + 4
        else:
            at += 1


def members(data, at):
    """Member -> its bytes."""
    found = {}
    for first, count, body in records(data, at):
        place = 0
        for member in range(first, first + count):
            length, = struct.unpack_from("<I", body, place)
            found[member] = body[place + 4:place + 4 + length]
            place += 4 + length
    return found


def text(body, at):
    length, = struct.unpack_from("<H", body, at)
    return body[at + 2:at + 2 + length].decode(), at + 2 + length


def ensemble_member(body, told):
    """Status, steps, q and p of a member of kind "ensemble"."""
    status, _, steps = struct.unpack_from("<iIq", body)
    at = 16 + (24 if told["h"] == "by member" else 0) + 8 * int(told["varied"])
    n, momenta = int(told["n"]), int(told["momenta"])
    state = struct.unpack_from("<%dd" % (n + momenta), body, at)
    return {"status": status, "steps": steps, "q": state[:n], "p": state[n:]}


def sweep_member(body, told):
    """Columns of a member of kind "sweep", or why it has none."""
    code, at = text(body, 0)
    if code != "ok":
        step, length = struct.unpack_from("<qI", body, at)
        return {"status": code, "step": step, "message": body[at + 12:at + 12 + length].decode()}
    names, at = text(body, at)
    names = names.split("\t")
    return dict(zip(names, struct.unpack_from("<%dd" % len(names), body, at)))


def named_values(body, told):
    """A cell of kind "stability", a point of kind "chart"."""
    out, at = {}, 0
    while at < len(body):
        name, at = text(body, at)
        letter, at = body[at:at + 1], at + 1
        if letter == b"s":
            out[name], at = text(body, at)
        elif letter in b"di":
            out[name], = struct.unpack_from("<" + ("d" if letter == b"d" else "q"), body, at)
            at += 8
        else:
            out[name] = letter == b"t"
    return out


READERS = {"ensemble": ensemble_member, "sweep": sweep_member, "stability": named_values,
           "chart": named_values}


def load(name):
    """The head of a file, and {member: what is known of it}."""
    with open(name, "rb") as file:
        data = file.read()
    told, at = head(data)
    read = READERS[told["kind"]]
    return told, {i: read(body, told) for i, body in sorted(members(data, at).items())}


if __name__ == "__main__":
    told, found = load(sys.argv[1])
    for key, value in told.items():
        print("%s = %s" % (key, value))
    for i, values in found.items():
        print(i, " ".join("%s=%r" % item for item in sorted(values.items())))
