"""What dmlua wrote, in Python: columns of files, and emitted C as functions. Standard library only.

    import dmlua                      # PYTHONPATH=$(dmlua --where python)
    data = dmlua.load("run.npy")      # {"t": ..., "q1": ..., ...}; also .csv, .tsv, .txt
    slope = dmlua.kernel("model.c", "slope")
    slope([0.3, -0.7, 0.0])           # the entries of out, as a list

Columns are NumPy arrays where NumPy is there, else lists of floats."""
import ast
import ctypes
import os
import re
import shutil
import struct
import subprocess
import tempfile

try:
    import numpy
except ImportError:
    numpy = None

__all__ = ["load", "kernel"]


# ---- columns ----

def _column(values):
    return numpy.array(values, dtype=float) if numpy else values


def _npy_head(data, name):
    """The description of an .npy file, and where its numbers begin."""
    if data[:6] != b"\x93NUMPY":
        raise ValueError("%s is not an npy file" % name)
    form, at = ("<H", 10) if data[6] == 1 else ("<I", 12)
    size, = struct.unpack_from(form, data, 8)
    return ast.literal_eval(data[at:at + size].decode("latin1")), at + size


def _load_npy(name):
    with open(name, "rb") as file:
        data = file.read()
    head, at = _npy_head(data, name)
    kinds = head["descr"]
    if isinstance(kinds, str):
        width = head["shape"][1] if len(head["shape"]) > 1 else 1
        kinds = [("c%d" % (c + 1), kinds) for c in range(width)]
    fields = []
    for field in kinds:
        if field[1] != "<f8":
            raise ValueError("%s: field %s has type %s; only <f8 is read" % (name, field[0], field[1]))
        count = field[2] if len(field) > 2 else None
        fields.append((field[0], count[0] if isinstance(count, tuple) else count))
    width = sum(count or 1 for _, count in fields)
    rows = head["shape"][0]
    if len(data) - at < 8 * rows * width:
        raise ValueError("%s ends before its last row" % name)
    numbers = struct.unpack_from("<%dd" % (rows * width), data, at)
    out, place = {}, 0
    for field, count in fields:
        if count is None:
            out[field] = _column(list(numbers[place::width]))
        else:
            out[field] = _column([list(numbers[i * width + place:i * width + place + count])
                                  for i in range(rows)])
        place += count or 1
    return out


def _load_text(name):
    with open(name, encoding="utf-8-sig") as file:
        lines = [line.rstrip("\n") for line in file]
    lines = [line.split("#")[0] if line.lstrip()[:1] in tuple("+-.0123456789") else line for line in lines]
    rows = [(i, line) for i, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    if not rows:
        raise ValueError("%s is empty" % name)
    last = rows[-1][1]
    sign = next((s for s in ("\t", ";", ",") if s in last), None)

    def fields(line):
        return [x.strip().strip('"') for x in (line.split(sign) if sign else line.split())]

    def number(text):
        return float(text.replace(",", ".") if sign != "," else text)

    names = fields(rows[0][1])
    try:
        [number(x) for x in names]
        names = ["c%d" % (c + 1) for c in range(len(names))]
    except ValueError:
        rows = rows[1:]
    columns = [[] for _ in names]
    for i, line in rows:
        row = fields(line)
        if len(row) != len(names):
            short = len(row) < len(names)
            raise ValueError("%s: line %d, column %s: %s: the line has %d fields, the first one %d" % (
                name, i, names[len(row)] if short else len(names) + 1,
                "nothing is there" if short else "one too many", len(row), len(names)))
        for c, text in enumerate(row):
            try:
                columns[c].append(number(text))
            except ValueError:
                raise ValueError("%s: line %d, column %s: not a number: %r" % (name, i, names[c], text)) from None
    return {key: _column(values) for key, values in zip(names, columns)}


def load(name):
    """The columns of a file by their names: .npy as path:npy writes it, else a text as path:csv does."""
    return _load_npy(name) if str(name).lower().endswith(".npy") else _load_text(name)


# ---- emitted C ----

_HEAD = re.compile(r"in\[(\d+)\], out\[(\d+)\] \*/\s*void (\w+)\(const double \*in, double \*out\)")
_libraries = []  # folders live as long as what was loaded from them


def _compile(name):
    compiler = os.environ.get("CC") or shutil.which("cc") or shutil.which("gcc")
    if not compiler:
        raise RuntimeError("no C compiler: install one (Debian, Ubuntu: apt install gcc), or set CC")
    folder = tempfile.TemporaryDirectory(prefix="dmlua")
    library = os.path.join(folder.name, "kernel.so")
    # no contraction: the bits are those of dmlua for + - * / and sqrt
    told = subprocess.run([*compiler.split(), "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-o", library,
                           str(name), "-lm"], capture_output=True, text=True)
    if told.returncode:
        raise RuntimeError("%s cannot be compiled: %s" % (name, told.stderr.strip()[:400]))
    _libraries.append(folder)
    return ctypes.CDLL(library)


def kernel(name, function):
    """A function of a file that system:emit_c or f:emit_c has written, compiled by cc.
    What it returns takes a sequence of numbers, in[], and gives a list, out[]."""
    with open(name) as file:
        sizes = {found[3]: (int(found[1]), int(found[2])) for found in _HEAD.finditer(file.read())}
    if function not in sizes:
        raise KeyError("%s has no function %s; there are %s" % (
            name, function, ", ".join(sorted(sizes)) or "none that dmlua has emitted"))
    inputs, outputs = sizes[function]
    call = getattr(_compile(name), function)
    call.argtypes, call.restype = [ctypes.c_void_p, ctypes.c_void_p], None
    make_in, make_out = ctypes.c_double * inputs, ctypes.c_double * outputs

    def run(numbers):
        if len(numbers) != inputs:
            raise ValueError("%s takes %d numbers (got %d)" % (function, inputs, len(numbers)))
        into = make_out()
        call(make_in(*map(float, numbers)), into)
        return list(into)

    run.__name__, run.__doc__ = function, "in[%d] -> out[%d]" % (inputs, outputs)
    return run
