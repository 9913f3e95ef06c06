"""Tables and parts made to harm: refused by name, in 1.5 GB of addresses and 20 seconds. Those whose hashes must be right are in the
tests of the libraries."""

import os
import resource
import struct
import unittest

import support

MOST_BYTES, MOST_SECONDS = 1_500_000_000, 20
UNCOMPRESSED, ZIP, DWAB = 0, 3, 9
MANY_PARTS = 0x1000


def limits():
    resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
    resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS))


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def text(name, value):
    return attribute(name, "string", value.encode())


def exr_part(name, width, height, compression, more=b""):
    """The header of a part of floats R, G, B."""
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(c + b"\0" + struct.pack("<4i", 2, 0, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
    return (text("name", name) + text("type", "scanlineimage") + attribute("channels", "chlist", channels) +
            attribute("compression", "compression", bytes([compression])) + attribute("dataWindow", "box2i", window) +
            attribute("displayWindow", "box2i", window) + attribute("lineOrder", "lineOrder", b"\0") +
            attribute("pixelAspectRatio", "float", struct.pack("<f", 1)) +
            attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)) +
            attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + more + b"\0")


def exr_file(*parts, pixels=b""):
    return struct.pack("<2i", 20000630, 2 | MANY_PARTS) + b"".join(parts) + b"\0" + pixels


def axes(*counts):
    """Attributes of axes with so many nodes."""
    result = text("sunbeam.schema_version", "3")
    for k, count in enumerate(counts):
        for key, value in (("name", f"a{k}"), ("unit", "1"), ("power", "1"), ("period", "0"), ("origin", "0"),
                           ("interpolation", "linear"), ("nodes", " ".join(map(str, range(count))))):
            result += text(f"sunbeam.axis.{k}.{key}", value)
    return result


class HostileTables(support.CliTest):
    def refuse_table(self, content, *naming):
        self.write("hostile.exr", content)
        self.refuse("info", "hostile.exr", naming=("hostile.exr: ", *naming), preexec_fn=limits)

    def test_pixels_that_the_file_does_not_hold(self):
        """A window of 6.4 GB that agrees with the axes."""
        part = exr_part("remainder", 31000, 17320, ZIP, axes(17320, 100, 310))
        self.refuse_table(exr_file(part, pixels=bytes(11000)), "its data windows ask for 1083 chunks")

    def test_pixels_of_many_parts(self):
        parts = [exr_part(f"array{k}", 20000, 2000, DWAB, axes(2000, 100, 200)) for k in range(8)]
        self.refuse_table(exr_file(*parts, pixels=bytes(40000)), "reading its pixels asks for", "MB of memory")

    def test_wide_rows(self):
        """One row is small; a chunk of 256 is not."""
        part = exr_part("remainder", 1 << 20, 1, DWAB, axes(1024, 1024))
        self.refuse_table(exr_file(part, pixels=bytes(1000)), "reading its pixels asks for")

    def test_rows_without_end(self):
        for height in ((1 << 29), 2147483644):
            self.refuse_table(exr_file(exr_part("a", 1, height, UNCOMPRESSED)), "not a usable OpenEXR file")

    def test_axes_larger_than_the_window(self):
        self.refuse_table(exr_file(exr_part("a", 2, 2, ZIP, axes(60000, 60000)), pixels=bytes(1000)), "array 'a'")

    def test_texts_without_end(self):
        part = exr_part("a", 2, 2, ZIP)[:-1] + b"s\0string\0" + struct.pack("<i", 2_000_000_000)
        self.refuse_table(exr_file(part), "attribute 's' claims 2000000000 bytes")
        part = exr_part("a", 2, 2, ZIP, attribute("v", "stringvector", struct.pack("<i", 2_000_000_000) + b"a"))
        self.refuse_table(exr_file(part), "its header ends too early")


# Its hash is right. Merging made room for 40 million parts, and listed them.
MANY_SHARDS = (b"SUNBAKE1" + struct.pack("<Q", 92) + b"b361e5246b657f565b1f28e8271ba252" +
               b"version 0.1.0\nrecipe_hash x\nencoding dense\nseed 1\nshard 0\nshards 40000000\nplan \n\n[material]\n")


class HostileParts(support.CliTest):
    def test_shards_without_end(self):
        self.write("hostile.part", MANY_SHARDS)
        self.refuse("merge", "hostile.part", "-o", "t.exr", preexec_fn=limits,
                    naming=["hostile.part: its header has shards '40000000'; allowed: 1 to 100000"])

    def test_no_file(self):
        os.mkfifo(self.folder / "fifo.part")
        for name in ("fifo.part", "/dev/zero", "/dev/null"):
            with self.subTest(name=name):
                self.refuse("merge", name, "-o", "t.exr", preexec_fn=limits, timeout=60,
                            naming=[f"{name}: is not a regular file"])


class Messages(support.CliTest):
    def test_control_characters_of_names(self):
        """A terminal must not do what a name says."""
        for name in ("a\x1b[2Jb.exr", "a\nb.exr", "a\x9b2J.exr", "a\x7f.exr"):
            with self.subTest(name=name):
                self.write(name, "no table")
                result = self.refuse("info", name)
                self.assertFalse([c for c in result.err[:-1] if ord(c) < 32 or 127 <= ord(c) < 160], result)


if __name__ == "__main__":
    unittest.main()
