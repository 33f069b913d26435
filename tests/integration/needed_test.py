#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a program of the runtime itself NEEDs (readelf -d): nothing of the offline side.

    needed_test.py PROGRAM [READELF]
"""
import re
import subprocess
import sys

FORBIDDEN = re.compile(r"assimp|libEGL|libGL|libepoxy|libmpi|libopen-rte|highgui|imgcodecs|videoio|libX11|libQt|libgtk")


def main():
    program = sys.argv[1]
    readelf = sys.argv[2] if len(sys.argv) > 2 else "readelf"
    output = subprocess.run([readelf, "-d", program], capture_output=True, text=True, check=True).stdout
    needed = re.findall(r"\(NEEDED\).*\[(.+)\]", output)
    if not any("libddsc" in name for name in needed):
        print("FAILED: it does not even need Cyclone DDS: is this the program?", needed)
        return 1
    bad = [name for name in needed if FORBIDDEN.search(name)]
    print("%d libraries: %s" % (len(needed), " ".join(needed)))
    if bad:
        print("FAILED: the runtime must not need", " ".join(bad))
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
