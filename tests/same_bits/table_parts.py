"""The attributes and arrays of a table file, as {name: bytes}, without the library that wrote it.

Names of attributes are those of docs/reference/table_format.md without `sunbeam.`; what belongs to an array is `ARRAY/NAME`, and the
values of an array are `array ARRAY` (in .vdb with what belongs to it).
"""

import re
import struct

PREFIX = "sunbeam."


class Reader:
    def __init__(self, content):
        self.content, self.at = content, 0

    def take(self, size):
        self.at += size
        return self.content[self.at - size:self.at]

    def number(self, layout):
        return struct.unpack("<" + layout, self.take(struct.calcsize("<" + layout)))[0]

    def text(self):
        """Text that ends with a zero byte."""
        end = self.content.index(b"\0", self.at)
        return self.take(end + 1 - self.at)[:-1].decode()

    def sized(self):
        return self.take(self.number("I"))


def key(array, name):
    of_file = name.startswith(PREFIX) and not name.startswith(PREFIX + "axis.")
    return name[len(PREFIX):] if of_file else f"{array}/{name.removeprefix(PREFIX)}"


# OpenEXR: headers, then where the chunks are, then the chunks (openexr.com, "OpenEXR File Layout").

def exr_header(reader):
    """One header, empty after the last."""
    header = {}
    while name := reader.text():
        reader.text()  # the type
        header[name] = reader.sized()
    return header


def exr_headers(reader, several):
    headers = [exr_header(reader)]
    while several and (header := exr_header(reader)):
        headers.append(header)
    return headers


def parts_of_exr(content):
    reader = Reader(content)
    reader.take(4)
    several = bool(reader.number("I") & 0x1000)
    headers = exr_headers(reader, several)
    names = [header["name"].decode() for header in headers]
    parts = {key(array, name): value for array, header in zip(names, headers) for name, value in header.items()}
    parts |= {f"array {array}": b"" for array in names}
    reader.at = reader.number("Q")  # the first chunk
    while reader.at < len(content):
        array = names[reader.number("I") if several else 0]
        row = reader.take(4)
        parts[f"array {array}"] += row + reader.sized()
    return parts


# OpenVDB: attributes, then the grids one after the other (openvdb/io/Archive.cc and GridDescriptor.cc). Our files do not say
# where a grid ends, so that they are split where a name and a type begin the next.

GRID = re.compile(rb"[\x01-\x40]\0\0\0([a-z_]+)[\x01-\x40]\0\0\0Tree_")


def vdb_attributes(reader):
    attributes = {}
    for _ in range(reader.number("I")):
        name = reader.sized().decode()
        reader.sized()  # the type
        attributes[name.removeprefix(PREFIX)] = reader.sized()
    return attributes


def parts_of_vdb(content):
    reader = Reader(content)
    reader.take(8 + 4 + 4 + 4 + 1 + 36)  # magic number, versions, whether offsets are known, UUID
    parts = vdb_attributes(reader)
    starts = list(GRID.finditer(content, reader.at))
    ends = [start.start() for start in starts[1:]] + [len(content)]
    return parts | {f"array {start[1].decode()}": content[start.start():end] for start, end in zip(starts, ends)}


def parts_of(path):
    return {".exr": parts_of_exr, ".vdb": parts_of_vdb}[path.suffix](path.read_bytes())
