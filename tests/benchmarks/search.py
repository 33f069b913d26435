#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The search's table behind docs/BENCHMARKS.md: scripts/bench search runs it.

A printed box (no symmetry, rz 0-360) among clutter, table constraint +-1.35 cm and +-12 deg, and images without it, from
fixed seeds. Counts are exact; times belong to the machine. Beside the figures of this run stand those of the run
before it (docs/search-figures.json; --keep writes this run's there), and the searches that this one replaces.
The data set and the model are kept in build/bench/search; the model is made again when the program is newer.
"""
import argparse
import json
import os

from programs import BIN, MESHES, ROOT, newer, run

OUT = os.path.join(ROOT, "build/bench/search")
KEPT = os.path.join(ROOT, "docs/search-figures.json")
COUNTS = ["nodes (64 cells each)", "parts (64 look-ups each)", "exact evaluations"]
TIMES = ["features", "exact tables", "lane tables", "search", "frame to pose"]


def prepare(images, absent):
    """The model and the data sets: with the object, and without."""
    os.makedirs(OUT, exist_ok=True)
    sextant = os.path.join(BIN, "sextant")
    model = os.path.join(OUT, "printed_box.sxm")
    if newer(sextant, model):
        print("search: learning the printed box", flush=True)
        run([sextant, "compile", os.path.join(MESHES, "printed_box.obj"), "-o", model, "--units", "mm", "--up", "z",
             "--object-id", 1, "--params", os.path.join(ROOT, "tests/benchmarks/search.yaml")])
    sets = []
    for name, with_it, without, seed in (("with", images, 0, 8000), ("without", 0, absent, 8500)):
        folder = os.path.join(OUT, f"{name}{with_it + without}")
        if not os.path.isdir(folder):
            things = []
            for other in ("bottle.ply@mm,z", "snack_tube.glb@m,y", "tea_box.obj@mm,z"):
                things += ["--distractor", os.path.join(MESHES, other)]
            run([sextant, "synthesize", os.path.join(MESHES, "printed_box.obj"), "--units", "mm", "--up", "z",
                 "--object-id", 1, "-o", folder, "--images", with_it, "--negatives", without, "--seed", seed,
                 "--occlusion", "0:0.2", "--clutter", "6:12", *things])
        sets.append(folder)
    return model, sets[0], sets[1]


def engine(model, folder, *options):
    figures = os.path.join(OUT, "figures.json")
    run([os.path.join(BIN, "sextant-engine-bench"), model, folder, "--json", figures, *options])
    with open(figures, encoding="utf-8") as f:
        return json.load(f)


def row(name, figures, before):
    old = before.get(name)
    print(f"\n{name}: {figures['images']} images, found in {figures['found']}, {figures['threads']} threads, {figures['bins']} bins,"
          f" tables {figures['table_bytes'] / 1e6:.0f} MB")
    for what in TIMES + COUNTS:
        if what not in figures["median"]:
            continue
        median, p99 = figures["median"][what], figures["p99"][what]
        ratio = ""
        if old and old["images"] == figures["images"] and old["median"].get(what):
            ratio = f"  x {median / old['median'][what]:.2f} of the run before"
        unit = "ms" if what in TIMES else "  "
        print(f"  {what:28} median {median:12,.1f} {unit} p99 {p99:12,.1f} {unit}{ratio}")


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench search", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--images", type=int, default=200)
    parser.add_argument("--absent", type=int, default=50)
    parser.add_argument("--repeats", type=int, default=2, help="the best time of so many counts")
    parser.add_argument("--old-images", type=int, default=4, help="images for the searches that this one replaces")
    parser.add_argument("--old-s", type=float, default=20, help="seconds for each of them")
    parser.add_argument("--keep", action="store_true", help="this run's figures become those to compare with")
    a = parser.parse_args()
    before = {}
    if os.path.exists(KEPT):
        with open(KEPT, encoding="utf-8") as f:
            before = json.load(f)
    model, present, absent = prepare(a.images, a.absent)
    repeat = ["--repeats", a.repeats]
    runs = [
        ("two threads", present, ["--threads", 2, *repeat]),
        ("one thread", present, ["--threads", 1, *repeat]),
        ("absent", absent, ["--threads", 2, *repeat]),
        ("no table", present, ["--threads", 2, "--no-table", "--images", min(a.images, 20)]),
        ("thesis scoring", present, ["--threads", 2, "--scoring", "thesis", "--images", min(a.images, 20)]),
    ]
    now = {}
    for name, folder, options in runs:
        now[name] = engine(model, folder, *options)
        row(name, now[name], before)
    one, two = now["one thread"]["median"]["search"], now["two threads"]["median"]["search"]
    print(f"\nsecond thread: x {one / two:.2f}")

    old = engine(model, present, "--threads", 1, "--images", a.old_images, "--plain-s", a.old_s, "--thesis-s", a.old_s)
    m = old["median"]
    print(f"\nthe searches that this one replaces, one thread, the first {old['images']} images, at most {a.old_s:.0f} s each:")
    for name, key in (("window minima, one region at a time", "plain"), ("the thesis's bounds and 64-way split", "thesis")):
        series = {"plain": "plain search", "thesis": "thesis's search"}[key]
        done = old[f"{key}_finished"]
        at_least = "" if done == old["images"] else "at least "
        print(f"  {name}: finished {done} of {old['images']}; {at_least}{m[series] / m['search']:.0f} times as long,"
              f" {m[series + ': regions']:,.0f} regions (this one: {m['nodes (64 cells each)']:,.0f} nodes of 64)")
    if a.keep:
        with open(KEPT, "w", encoding="utf-8") as f:
            json.dump(now, f, indent=1)
            f.write("\n")


if __name__ == "__main__":
    main()
