#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads the #includes of every source file and checks them against the arrows of cmake/SextantRooms.cmake.

CMake checks what rooms link; an include of a header that needs no linking would slip through. Some external
headers are ours in one place only. First it checks itself on a made-up tree with every kind of violation.
"""
import re
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOPS = ("runtime", "hal", "offline", "idl")
SOURCES = {".h", ".cpp", ".c", ".cc", ".hpp"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
GENERATED = ("idl/",)  # headers that the build makes; others are made from a .in file beside them
# (headers, where they may be used; empty: nowhere of the folders checked)
DDS = (re.compile(r"^(dds/|ddsc/|idl/dds/)"), ("runtime/publish", "hal/dds"))
CONFINED = [
    DDS,
    (re.compile(r"^(assimp/|EGL/|GL/|GLES\d?/|epoxy/|mpi\.h)"), ("offline",)),
    (re.compile(r"^opencv2/(highgui|imgcodecs|videoio)"), ()),
    (re.compile(r"^(gtest|gmock|benchmark)/"), ()),
]


def read_table(text):
    """{"kind": {kinds it may use}} of SextantRooms.cmake."""
    table = {}
    for kind, rest in re.findall(r"^set\(SEXTANT_MAY_USE_(\w+)\s*([^)]*)\)", text, re.M):
        rest = re.sub(r"\$\{SEXTANT_MAY_USE_(\w+)\}", lambda other: " ".join(table[other[1]]), rest)
        table[kind] = set(rest.replace('"', "").split())
    return table


def kind_of(path):
    """The row of the table that rules a file such as runtime/search/region.h."""
    parts = path.split("/")
    if parts[0] == "runtime":
        return parts[1] if len(parts) > 2 else None
    if parts[:2] == ["offline", "mpi"]:
        return "mpi"
    return parts[0] if parts[0] in TOPS else None


def violations(root, table):
    found, seen = [], 0
    for top in TOPS:
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in SOURCES:
                continue
            seen += 1
            file = path.relative_to(root).as_posix()
            kind = kind_of(file)
            for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
                match = INCLUDE.match(line)
                if not match:
                    continue
                quote, target = match.groups()
                where = "%s:%d" % (file, number)
                for pattern, places in CONFINED:
                    if pattern.match(target) and not any(file.startswith(place + "/") for place in places):
                        found.append("%s: %s belongs only in %s" % (where, target, places or "no room at all"))
                if quote == "<":
                    continue
                target_kind = kind_of(target)
                if target_kind is None:
                    found.append("%s: \"%s\" is not written from the repository's root" % (where, target))
                elif kind not in table or target_kind not in table:
                    found.append("%s: %s -> %s has no row in the table" % (where, kind, target_kind))
                elif target_kind != kind and target_kind not in table[kind]:
                    found.append("%s: %s may not use %s (%s)" % (where, kind, target_kind, target))
                elif not (any((root / (target + end)).is_file() for end in ("", ".in"))
                          or target.startswith(GENERATED)):
                    found.append("%s: %s does not exist" % (where, target))
    return found, seen


def check_myself(table):
    """Each line is one violation, and the good ones are none."""
    bad = {
        "runtime/geometry/a.h": ['#include "runtime/search/x.h"'],
        "runtime/search/a.cpp": ['#include "offline/mesh/x.h"', "#include <assimp/scene.h>", "#include <mpi.h>"],
        "runtime/detect/a.cpp": ['#include "idl/dds/std_msgs.h"', "#include <dds/dds.h>"],
        "runtime/frame/a.cpp": ["#  include <opencv2/highgui.hpp>", '#include "rgbd_frame.h"'],
        "hal/playback/a.cpp": ['#include "runtime/search/x.h"', "#include <EGL/egl.h>", "#include <epoxy/gl.h>"],
        "runtime/publish/a.cpp": ['#include "runtime/daemon/x.h"', '#include "runtime/refine/missing.h"'],
        "offline/mesh/a.cpp": ['#include "runtime/daemon/x.h"'],
        "runtime/unheard_of/a.cpp": ['#include "runtime/refine/x.h"'],
    }
    good = {
        "runtime/publish/b.cpp": ["#include <dds/dds.h>", '#include "runtime/refine/x.h"', '#include "idl/dds/y.h"'],
        "runtime/refine/x.h": ["#include <vector>", '#include "runtime/base/x.h"', '// #include "offline/x/y.h"'],
        "runtime/base/x.h": [], "runtime/search/x.h": [], "runtime/daemon/x.h": [], "offline/mesh/x.h": [],
        "offline/mpi/b.cpp": ['#include "runtime/daemon/x.h"', "#include <mpi.h>", '#include "offline/mesh/x.h"'],
        "offline/render/b.cpp": ["#include <epoxy/gl.h>", '#include "offline/mesh/x.h"'],
    }
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for file, lines in {**bad, **good}.items():
            (root / file).parent.mkdir(parents=True, exist_ok=True)
            (root / file).write_text("\n".join(lines) + "\n", encoding="utf-8")
        found, seen = violations(root, table)
        # One line breaks two rules: generated DDS headers are confined, and detect may not use idl.
        expected = sum(len(lines) for lines in bad.values()) + 1
        if len(found) != expected or any(violation.split(":")[0] in good for violation in found):
            return ["self check: expected %d violations, found %d:" % (expected, len(found))] + found
        return [] if seen == len(bad) + len(good) else ["self check: %d files seen" % seen]


def main():
    table = read_table((ROOT / "cmake" / "SextantRooms.cmake").read_text(encoding="utf-8"))
    failures = check_myself(table)
    found, seen = violations(ROOT, table)
    failures += found
    if seen < 20 or len(table) < 10:
        failures.append("only %d files and %d rows seen: is this the repository?" % (seen, len(table)))
    for failure in failures:
        print("FAILED:", failure)
    print("%d files, %d rows of the table, %d violations" % (seen, len(table), len(failures)))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
