"""symbols.py NM OBJECT...: the objects define no mergeable function but those named after their instruction set.

The linker keeps one of equal inline functions. Were it one compiled for AVX2, programs would fail on machines
without AVX2.
"""

import subprocess
import sys


def mergeable_functions(nm, path):
    lines = subprocess.run([nm, "-C", path], check=True, capture_output=True, text=True).stdout.splitlines()
    return [line.split(" W ", 1)[1] for line in lines if " W " in line]


def main():
    nm, *objects = sys.argv[1:]
    found = [name for path in objects for name in mergeable_functions(nm, path)]
    shared = [name for name in found if "avx" not in name.lower()]
    print(f"{len(objects)} objects, {len(found)} mergeable functions, of these shared: {shared}")
    if shared or (objects and not found):
        sys.exit(1)


main()
