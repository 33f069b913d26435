#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The accuracy protocol behind docs/BENCHMARKS.md: scripts/bench accuracy runs it.

Eight bundled objects; per sensor model 200 images unoccluded and 100 with 20-40 % occluded, two objects in each, with
decoys of their size, and 150 negatives. Two halves by construction: every seed of the development half (what parameters
may be tuned on) differs from every seed of the report half. Confidence and thresholds are calibrated on scenes with seeds
of their own, as docs/measure-accuracy.md advises. Peers (OpenCV's PPF and LINEMOD, where
libopencv-contrib-dev is installed) answer on the first images of the same sets. With --rgbd, real frames as well.
Data sets, models and results are kept in build/bench/accuracy and made again when the program is newer.
"""
import argparse
import json
import math
import os
import sys
import time

from programs import BIN, MESHES, ROOT, newer, run

SEEDS = {"development": 1000, "report": 9000}
CALIBRATION_SEED = 5000
SENSORS = ["kinect1", "xtion", "realsense"]
OBJECTS = [  # id, name, mesh, units, up
    (1, "printed_box", "printed_box.obj", "mm", "z"),
    (2, "bottle", "bottle.ply", "mm", "z"),
    (3, "mug", "mug.stl", "mm", "z"),
    (4, "can", "can.glb", "m", "y"),
    (5, "tea_box", "tea_box.obj", "mm", "z"),
    (6, "snack_tube", "snack_tube.glb", "m", "y"),
    (7, "sauce_bottle", "sauce_bottle.glb", "m", "y"),
    (8, "drill", "drill.ply", "mm", "z"),
]


def say(text):
    print(text, flush=True)


class Protocol:
    def __init__(self, arguments):
        self.a = arguments
        self.out = os.path.join(ROOT, "build/bench/accuracy")
        self.sextant = os.path.join(BIN, "sextant")
        os.makedirs(self.out, exist_ok=True)
        self.rows = []
        self.objects = [o for o in OBJECTS if o[0] in arguments.objects]
        self.ids = ["--objects", ",".join(str(o[0]) for o in self.objects)]

    # ---- models and data sets -------------------------------------------------------------------------
    def compile(self, name, mesh, object_id, units, up, parameters, more=()):
        model = os.path.join(self.out, "models", f"{name}.sxm")
        os.makedirs(os.path.dirname(model), exist_ok=True)
        if self.a.keep_models and os.path.exists(model) or not newer(self.sextant, model):
            return model
        start = time.time()
        run([self.sextant, "compile", mesh, "--units", units, "--up", up, "--object-id", object_id, "--params", parameters,
             "-o", model, *more])
        say(f"   learnt {name} in {time.time() - start:.0f} s")
        return model

    def models(self):
        parameters = os.path.join(ROOT, "tests/benchmarks/synthetic.yaml")
        return [self.compile(name, os.path.join(MESHES, mesh), i, units, up, parameters)
                for i, name, mesh, units, up in self.objects]

    def calibrate(self, models):
        done = os.path.join(self.out, "models", "calibrated")
        if self.a.calibration == 0 or os.path.exists(done) and not any(newer(m, done) for m in models):
            return
        sets = [self.dataset(f"{sensor}_calibration", CALIBRATION_SEED + 10 * SENSORS.index(sensor), sensor, "0:0.4",
                             self.a.calibration, self.a.calibration // 2) for sensor in SENSORS]
        start = time.time()
        say(run([self.sextant, "calibrate", *models, "--dataset", *sets, "--angle-tolerance-deg", 6]).rstrip())
        say(f"   calibrated in {time.time() - start:.0f} s")
        with open(done, "w", encoding="utf-8"):
            pass

    def dataset(self, name, seed, sensor, occlusion, images, negatives):
        folder = os.path.join(self.out, "sets", f"{name}_{seed}_{images}_{negatives}_{len(self.objects)}")
        done = os.path.join(folder, "test/000001/scene_gt.json")
        if self.a.keep_sets and os.path.exists(done) or not newer(self.sextant, done):
            return folder
        specs = [f"{os.path.join(MESHES, mesh)}@{units},{up}" for _, _, mesh, units, up in self.objects]
        others = [f"{os.path.join(MESHES, mesh)}@{units},{up}" for o in OBJECTS if o not in self.objects
                  for _, _, mesh, units, up in [o]]
        start = time.time()
        run([self.sextant, "synthesize", *specs, "--object-id", *[o[0] for o in self.objects], "-o", folder, "--images", images,
             "--negatives", negatives, "--objects-per-image", min(2, len(self.objects)), "--sensor", sensor, "--occlusion", occlusion, "--seed", seed,
             *(["--distractor", *others] if others else [])])
        say(f"   made {images} + {negatives} images in {time.time() - start:.0f} s: {folder}")
        return folder

    # ---- answers and their judgement ------------------------------------------------------------------
    def detect(self, folder, csv, models, more=()):
        run([self.sextant, "detect", *models, "--dataset", folder, "--csv", csv, "--angle-tolerance-deg", 6,
             *self.a.detect_options.split(), *more])
        return csv

    def evaluate(self, folder, csv, more=()):
        report = csv[:-4] + ".html"
        text = run([self.sextant, "evaluate", "--dataset", folder, "--csv", csv, "--json", "--report", report, *more])
        result = json.loads(text)
        with open(csv[:-4] + ".json", "w", encoding="utf-8") as f:
            f.write(text)
        return result

    def add_row(self, what, who, result):
        t = result["total"]
        show = lambda v, s: "-" if v is None else format(v, s)
        # What an object that is never found would hide: the CSV names no such row, --objects does.
        aps = [o["average_precision"] for o in result["objects"].values() if o["instances"] > 0]
        self.rows.append([what, who, str(t["instances"]), f"{100 * t['share_right']:.1f} %", f"{100 * t['share_strict']:.1f} %",
                          f"{10 * t['median_translation_cm']:.1f}", f"{min(aps):.3f}" if aps else "-",
                          show(t["average_recall"], ".3f"), f"{t['false_detections']}/{t['false_images']}",
                          show(t["calibration_error"], ".3f"), show(result["seconds"], ".3f")])

    def print_rows(self):
        head = ["set", "who", "instances", "1 cm, 15 deg", "5 mm, 5 deg", "median mm", "worst AP", "BOP AR",
                "false / images without", "calibration", "s per image, all objects"]
        say("| " + " | ".join(head) + " |")
        say("|" + "---|" * len(head))
        for row in self.rows:
            say("| " + " | ".join(row) + " |")

    # ---- the parts of the protocol --------------------------------------------------------------------
    def synthetic(self, models):
        for k, sensor in enumerate(self.a.sensors):
            seed = SEEDS[self.a.half] + 10 * SENSORS.index(sensor)
            clear = round(self.a.images * 2 / 3)
            parts = [("clear", "0:0.05", seed, clear, round(self.a.negatives * 2 / 3)),
                     ("occluded", "0.2:0.4", seed + 1, self.a.images - clear, self.a.negatives - round(self.a.negatives * 2 / 3))]
            for name, occlusion, part_seed, images, negatives in parts:
                if images == 0:
                    continue
                what = f"{sensor} {name}"
                say(f"== {what}")
                folder = self.dataset(f"{sensor}_{name}", part_seed, sensor, occlusion, images, negatives)
                csv = self.detect(folder, os.path.join(self.out, f"{self.a.half}_{sensor}_{name}.csv"), models)
                self.add_row(what, "sextant", self.evaluate(folder, csv, self.ids))
                if k == 0 and self.a.peers > 0 and name == "clear":
                    self.peers(sensor, part_seed, models)

    def peers(self, sensor, seed, models):
        programs = [(p, os.path.join(BIN, f"sextant-peer-{p}")) for p in ("linemod", "ppf")]
        programs = [(p, b) for p, b in programs if os.path.exists(b)]
        if not programs:
            say("   peers skipped: libopencv-contrib-dev was not installed when Sextant was built")
            return
        negatives = self.a.peers // 2
        folder = self.dataset(f"{sensor}_peers", seed, sensor, "0:0.05", self.a.peers, negatives)
        what = f"{sensor} clear, {self.a.peers} + {negatives} images"
        csv = self.detect(folder, os.path.join(self.out, f"{self.a.half}_{sensor}_peers_sextant.csv"), models)
        self.add_row(what, "sextant", self.evaluate(folder, csv, self.ids))
        for name, program in programs:
            csv = os.path.join(self.out, f"{self.a.half}_{sensor}_peers_{name}.csv")
            specs = [f"{i}={os.path.join(MESHES, mesh)}@{units},{up}" for i, _, mesh, units, up in self.objects]
            say("   " + run([program, "--object", *specs, "--dataset", folder, "--csv", csv]).strip().replace("\n", "; "))
            self.add_row(what, name, self.evaluate(folder, csv, self.ids))

    def real(self):
        """Upright labelled instances that are at least 70 % visible (gt_check.json of the sets), strict and by shape."""
        sets = [("mosd_kinect_parametric", "mosd.yaml", "z"), ("ycb_rs_6dofgraspnet", "ycb_rs.yaml", None),
                ("ycbv_samples", "ycbv.yaml", None)]
        for name, parameters, up in sets:
            folder = os.path.join(self.a.rgbd, name)
            if not os.path.isdir(folder):
                say(f"== {name}: not there, skipped")
                continue
            say(f"== {name}")
            wanted, ups = upright_instances(folder, up)
            parameters = os.path.join(ROOT, "tests/benchmarks", parameters)
            models = []
            for i in sorted(ups):
                mesh = os.path.join(folder, "models", f"obj_{i:06}.ply")
                models.append(self.compile(f"{name}_{i}", mesh, i, "mm", ups[i], parameters))
            csv = self.detect(folder, os.path.join(self.out, f"{name}.csv"), models)
            ids = ["--objects", ",".join(str(i) for i in sorted(ups))]
            up_options = [x for i in sorted(ups) for x in ("--up", f"{i}={ups[i]}")]
            # What only the print tells: the shape's own symmetry, as the compiler detected it.
            forgiven = [x for i, m in zip(sorted(ups), models) for x in ("--symmetry", f"{i}={self.shape_symmetry(m)}")]
            for label, more in [("strict", []), ("by shape", forgiven)]:
                result = self.evaluate(folder, csv, ids + up_options + more)
                self.rows.append(summary_of_real(f"{name}, {label}", result, wanted))

    def shape_symmetry(self, model):
        return json.loads(run([self.sextant, "inspect", model, "--json"]))["geometric_symmetry_deg"]


AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "-x": (-1, 0, 0), "-y": (0, -1, 0), "-z": (0, 0, -1)}


def upright_instances(folder, up):
    """{(scene, image, object)} that stand and are seen, and {object: axis that points up}."""
    wanted, ups = set(), {}
    test = os.path.join(folder, "test")
    for scene in sorted(os.listdir(test)):
        with open(os.path.join(test, scene, "gt_check.json"), encoding="utf-8") as f:
            for image, entries in json.load(f).items():
                for e in entries:
                    axis, cosine = max(((a, sum(p * q for p, q in zip(v, e["up_obj"]))) for a, v in AXES.items()),
                                       key=lambda pair: pair[1])
                    stands = cosine > math.cos(math.radians(8)) and (up is None or axis == up)
                    # A lying tool is upright about no axis that its model would be compiled for.
                    if not stands or e["visib"] < 0.7 or ups.get(e["obj"], axis) != axis:
                        continue
                    ups[e["obj"]] = axis
                    wanted.add((int(scene), int(image), e["obj"]))
    return wanted, ups


def summary_of_real(what, result, wanted):
    seen = [i for i in result["instances"] if (i["scene_id"], i["im_id"], i["obj_id"]) in wanted]
    right = sum(i["right"] for i in seen)
    errors = sorted(i["translation_cm"] for i in seen if i["found"])
    strict = sum(i["found"] and i["translation_cm"] <= 0.5 and i["rotation_deg"] <= 5 for i in seen)
    median = f"{10 * errors[len(errors) // 2]:.1f}" if errors else "-"
    n = max(1, len(seen))
    return [what, "sextant", str(len(seen)), f"{100 * right / n:.1f} %", f"{100 * strict / n:.1f} %", median, "-", "-", "-", "-",
            "-" if result["seconds"] is None else f"{result['seconds']:.3f}"]


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench accuracy", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--half", choices=sorted(SEEDS), default="development",
                        help="report: the seeds that nothing is ever tuned on, for the table in the docs")
    parser.add_argument("--images", type=int, default=300, help="with objects, per sensor (default 300)")
    parser.add_argument("--negatives", type=int, default=150, help="without, per sensor (default 150)")
    parser.add_argument("--objects", type=int, nargs="+", default=[o[0] for o in OBJECTS], choices=[o[0] for o in OBJECTS],
                        help="ids; the other bundled objects then stand around without a label (default: all)")
    parser.add_argument("--sensors", nargs="+", choices=SENSORS, default=SENSORS)
    parser.add_argument("--peers", type=int, default=60, help="images for the peers, on the first sensor; 0: none")
    parser.add_argument("--rgbd", default="", help="folder of the real sets (docs/BENCHMARKS.md)")
    parser.add_argument("--no-synthetic", action="store_true")
    parser.add_argument("--calibration", type=int, default=60,
                        help="images per sensor for the calibration, and half as many without objects; 0: general weights")
    parser.add_argument("--detect-options", default="", help="for sextant detect, e.g. '--scoring thesis'")
    parser.add_argument("--keep-models", action="store_true", help="also where the program is newer than the models")
    parser.add_argument("--keep-sets", action="store_true", help="the same for the data sets")
    arguments = parser.parse_args()
    protocol = Protocol(arguments)
    start = time.time()
    if not arguments.no_synthetic:
        models = protocol.models()
        protocol.calibrate(models)
        protocol.synthetic(models)
    if arguments.rgbd:
        protocol.real()
    say("")
    say(f"half: {arguments.half}, {arguments.images} + {arguments.negatives} images per sensor, {time.time() - start:.0f} s")
    protocol.print_rows()
    say(f"pages with pictures of what went wrong: {protocol.out}/*.html")


if __name__ == "__main__":
    main()
