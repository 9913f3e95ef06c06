"""montage.py OUT.png COLUMNS A.png B.png ...: pictures of one size side by side, row by row; "-" leaves a place empty.

Reads PNGs as sunbeam writes them (grey, RGB or palette of 8 bits, not interlaced) and writes RGB, by the standard library alone.
"""

import pathlib
import struct
import sys
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"
GAP = 4  # pixels between pictures
BACKGROUND = b"\xff\xff\xff"
STEP = 4  # values are rounded to its multiples: below the noise of a rendering, and a third less to store
ROUNDED = bytes(min(255, (v + STEP // 2) // STEP * STEP) for v in range(256))
CHANNELS = {0: 1, 2: 3, 3: 1}  # of the PNG colour types grey, RGB, palette


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def chunks(data):
    at = len(SIGNATURE)
    while at < len(data):
        size, = struct.unpack_from(">I", data, at)
        yield data[at + 4:at + 8], data[at + 8:at + 8 + size]
        at += size + 12


def unfiltered(kind, line, above, step):
    """A row's bytes from its differences to the left, above, their mean or Paeth's predictor (PNG, section 9)."""
    row = bytearray(line)
    for i in range(len(row) if kind else 0):
        left = row[i - step] if i >= step else 0
        corner = above[i - step] if i >= step else 0
        guess = (0, left, above[i], (left + above[i]) // 2, paeth(left, above[i], corner))[kind]
        row[i] = (row[i] + guess) & 255
    return row


def read_png(path):
    """Width and rows of R, G, B bytes."""
    data = pathlib.Path(path).read_bytes()
    if not data.startswith(SIGNATURE):
        sys.exit(f"{path}: is no PNG file")
    parts = list(chunks(data))
    width, height, bits, colour, _, _, interlace = struct.unpack(">IIBBBBB", parts[0][1])
    if bits != 8 or colour not in CHANNELS or interlace:
        sys.exit(f"{path}: found {bits} bits, colour type {colour}, interlace {interlace}; allowed: 8 bits, 0, 2 or 3, 0")
    step = CHANNELS[colour]
    palette = next((body for name, body in parts if name == b"PLTE"), bytes(v for g in range(256) for v in (g, g, g)))
    stream = zlib.decompress(b"".join(body for name, body in parts if name == b"IDAT"))
    rows, row = [], bytearray(width * step)
    for y in range(height):
        start = y * (width * step + 1)
        row = unfiltered(stream[start], stream[start + 1:start + 1 + width * step], row, step)
        rows.append(bytes(row) if step == 3 else b"".join(palette[3 * v:3 * v + 3] for v in row))
    return width, rows


def filtered(row, above):
    """The shorter looking of two encodings of a row: by the sum of absolute differences."""
    candidates = [(1, bytes((v - (row[i - 3] if i >= 3 else 0)) & 255 for i, v in enumerate(row))),
                  (4, bytes((v - paeth(row[i - 3] if i >= 3 else 0, above[i], above[i - 3] if i >= 3 else 0)) & 255
                            for i, v in enumerate(row)))]
    kind, line = min(candidates, key=lambda c: sum(min(v, 256 - v) for v in c[1]))
    return bytes([kind]) + line


def write_png(path, rows):
    width = len(rows[0]) // 3
    stream = b"".join(filtered(row, above) for row, above in zip(rows, [bytes(3 * width)] + rows))

    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    head = struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)
    pathlib.Path(path).write_bytes(SIGNATURE + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(stream, 9)) +
                                   chunk(b"IEND", b""))


def main():
    out, columns, names = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
    pictures = {name: read_png(name) for name in names if name != "-"}
    sizes = {(width, len(rows)) for width, rows in pictures.values()}
    if len(sizes) != 1:
        sys.exit(f"found pictures of {len(sizes)} sizes; allowed: one size")
    width, height = sizes.pop()
    names += ["-"] * (-len(names) % columns)
    empty = BACKGROUND * width
    result = []
    for first in range(0, len(names), columns):
        if first:
            result += [BACKGROUND * (columns * (width + GAP) - GAP)] * GAP
        for y in range(height):
            result.append((BACKGROUND * GAP).join(pictures[name][1][y].translate(ROUNDED) if name in pictures else empty
                                                  for name in names[first:first + columns]))
    write_png(out, result)


main()
