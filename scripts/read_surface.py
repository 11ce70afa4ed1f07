"""Reads the triangles of a surface file: STL, OBJ, PLY. For the scripts beside this file; the simulator has its own reader."""
import os
import struct

import numpy

MOST_BYTES = 64 << 20  # as the simulator reads
BYTE_ORDER_MARK = b"\xef\xbb\xbf"
PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
             "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
             "double": "f8", "float64": "f8"}


class SurfaceError(Exception):
    """Says which file and why."""


def read_surface(path):
    """Corners of the triangles, n x 3 x 3, in the file's unit."""
    readers = {".stl": read_stl, ".obj": read_obj, ".ply": read_ply}
    reader = readers.get(os.path.splitext(path)[1].lower())
    if reader is None:
        raise SurfaceError("%s has none of the endings %s" % (path, ", ".join(readers)))
    try:
        if not os.path.isfile(path):
            raise SurfaceError("%s is no file" % path)
        if os.path.getsize(path) > MOST_BYTES:
            raise SurfaceError("%s has more than %d bytes" % (path, MOST_BYTES))
        with open(path, "rb") as stream:
            data = stream.read()
    except OSError as error:
        raise SurfaceError("%s cannot be read: %s" % (path, error.strerror)) from error
    if data.startswith(b"version https://git-lfs"):
        raise SurfaceError("%s is a git-lfs pointer, not the data itself; fetch it with: git lfs pull" % path)
    try:
        corners = reader(data)
    except (ValueError, IndexError, KeyError, OverflowError, struct.error, UnicodeDecodeError) as error:
        raise SurfaceError("%s is damaged or no surface: %s" % (path, error)) from error
    if not len(corners) or not numpy.isfinite(corners).all():
        raise SurfaceError("%s has %s" % (path, "coordinates that are not finite" if len(corners) else "no triangles"))
    return corners


def read_stl(data):
    count = struct.unpack("<I", data[80:84])[0] if len(data) >= 84 else 0
    text = (data[3:] if data.startswith(BYTE_ORDER_MARK) else data).lstrip()
    name_end = min((at for at in (text.find(b"\n"), text.find(b"\r")) if at >= 0), default=0)
    facet_near = b"facet" in text[:1024].lower() or b"facet" in text[name_end:name_end + 1024].lower()  # behind a long name
    is_text = text[:5].lower() == b"solid" and facet_near
    rest = len(data) - 84 - 50 * count
    if rest == 0 or (count > 0 and 0 < rest < 50 and not is_text):  # some write a few bytes behind
        return numpy.frombuffer(data, "(3,)<f4, (3, 3)<f4, <u2", count, 84)["f1"].astype(float)
    if count > 0 and not is_text:
        raise ValueError("it has %d bytes, and %d triangles take %d" % (len(data), count, 84 + 50 * count))
    words = [text_of(line).split() for line in data.lower().splitlines()]
    corners = numpy.array([word[1:4] for word in words if word and word[0] == "vertex"], dtype=float)
    return corners.reshape(-1, 3, 3)


def text_of(data):
    """Numbers and keywords are ASCII; names and comments may be anything, and come after a byte-order mark at times."""
    return (data[3:] if data.startswith(BYTE_ORDER_MARK) else data).decode("latin-1")


def fan(face):
    """Triangles of a polygon."""
    return [(face[0], face[i], face[i + 1]) for i in range(1, len(face) - 1)]


def picked(vertices, triangles):
    triangles = numpy.array(triangles, dtype=int).reshape(-1, 3)
    if len(triangles) and not 0 <= triangles.min() <= triangles.max() < len(vertices):
        raise ValueError("a face names a vertex that is not there")
    return numpy.array(vertices, dtype=float).reshape(-1, 3)[triangles]


def read_obj(data):
    vertices, triangles = [], []
    lines = [text_of(line) for line in data.splitlines()]
    if lines and lines[0].split()[:1] == ["P"]:
        raise ValueError("it is an .obj of MNI's tools, not of Wavefront's; save it as .stl or .ply")
    word = []
    for number, line in enumerate(lines, 1):
        word = (word[:-1] if word[-1:] == ["\\"] else []) + line.split("#")[0].split()  # goes on in the next line
        if word[-1:] == ["\\"]:
            continue
        try:
            if word and word[0] == "v":
                vertices.append([float(text) for text in word[1:4]])
            elif word and word[0] == "f":
                face = [int(text.split("/")[0]) for text in word[1:]]
                triangles += fan([i - 1 if i > 0 else len(vertices) + i for i in face])
        except ValueError as error:
            raise ValueError("line %d: %s" % (number, error)) from error
        if len(word) < 4 and (word[:1] == ["v"] or (word[:1] == ["f"] and number == len(lines))):
            raise ValueError("line %d has %d numbers and needs three; is the file cut off?" % (number, len(word) - 1))
    return picked(vertices, triangles)


class PlyNumbers:
    """The numbers behind the header, one after the other, text or bytes."""

    def __init__(self, data, form):
        self._words = iter(data.split()) if form == "ascii" else None
        self._data, self._at = data, 0
        self._order = ">" if form == "binary_big_endian" else "<"

    def next(self, kind):
        if self._words is not None:
            word = next(self._words, None)
            if word is None:
                raise ValueError("it ends early")
            return float(word)
        kind = numpy.dtype(self._order + kind)
        if self._at + kind.itemsize > len(self._data):
            raise ValueError("it ends early")
        value = numpy.frombuffer(self._data, kind, 1, self._at)[0]
        self._at += kind.itemsize
        return float(value)


def read_ply(data):
    end = data.index(b"end_header")
    header = [text_of(line).split() for line in data[:end].splitlines()]
    if header[0] != ["ply"]:
        raise ValueError("its first line is not 'ply'")
    form = next((words[1] for words in header if words and words[0] == "format"), "")
    if form not in ("ascii", "binary_little_endian", "binary_big_endian"):
        raise ValueError("its header has no line 'format' with ascii, binary_little_endian or binary_big_endian")
    numbers = PlyNumbers(data[data.index(b"\n", end) + 1:], form)
    elements = []
    for words in header:
        if words and words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words and words[0] == "property":
            elements[-1][2].append(words[1:])
    vertices, triangles = [], []
    for element, count, properties in elements:
        if not 0 <= count <= len(data):  # a byte each is the least, and a number of no bytes would be counted through for hours
            raise ValueError("its header has %d times %s; it may be 0 to %d, as the bytes of the file" % (count, element, len(data)))
        for _ in range(count if properties else 0):
            row = {}
            for kind in properties:
                if kind[0] == "list":
                    length = int(numbers.next(PLY_TYPES[kind[1]]))
                    row[kind[3]] = [int(numbers.next(PLY_TYPES[kind[2]])) for _ in range(length)]
                else:
                    row[kind[1]] = numbers.next(PLY_TYPES[kind[0]])
            if element == "vertex":
                vertices.append([row["x"], row["y"], row["z"]])
            elif element == "face":
                triangles += fan(row.get("vertex_indices", row.get("vertex_index", [])))
    return picked(vertices, triangles)
