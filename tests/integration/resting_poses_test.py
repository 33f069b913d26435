#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""One object in two resting poses: two models from one command, and whichever way it lies it is found, once."""
import csv
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

BIN, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
SEXTANT = BIN / "sextant"
MESH = SOURCE / "data/meshes/printed_box.obj"
PARAMETERS = """min_pitch_deg: 40
max_pitch_deg: 42
max_roll_deg: 0
angle_tolerance_deg: 3
images_per_bin: 20
scenes_per_bin: 8
grid: 32
"""
failures = []


def check(condition, what):
    if not condition:
        failures.append(what)
        print("FAILED:", what)


def run(*command, expect=0):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=800)
    check(done.returncode == expect, f"exit {done.returncode}, expected {expect}: {' '.join(map(str, command))}\n"
          f"{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done


def main(folder):
    (folder / "learning.yaml").write_text(PARAMETERS)
    model = folder / "box.sxm"
    options = ["--units", "mm", "--object-id", 1, "--params", folder / "learning.yaml", "-o", model]
    for wrong in (("--rest", "0,0"), ("--rest", "0,x"), ("--rest", "0,99"), ("--rest", "all", "--up", "z")):
        refused = run(SEXTANT, "compile", MESH, *options, *wrong, expect=2)
        check(refused.stderr.count("\n") == 1, f"one line: {refused.stderr}")
    done = run(SEXTANT, "compile", MESH, *options, "--rest", "0,2")
    models = [model, folder / "box.rest2.sxm"]
    check(all(m.exists() for m in models), f"a model for each resting pose: {done.stdout}")
    names = [json.loads(run(SEXTANT, "inspect", m, "--json").stdout) for m in models]
    check([n["name"] for n in names] == ["printed_box", "printed_box.rest2"], f"names: {[n['name'] for n in names]}")

    statuses = []
    for rest in (0, 2):
        scene = folder / f"rest{rest}"
        run(SEXTANT, "synthesize", MESH, "--units", "mm", "--rest", rest, "--object-id", 1, "-o", scene, "--images", 4,
            "--seed", 90 + rest, "--pitch-deg", "40:42", "--roll-deg", "0:0")
        answers = folder / f"rest{rest}.csv"
        detect = [SEXTANT, "detect", *models, "--dataset", scene, "--angle-tolerance-deg", 4, "--false-positive-rate", 1]
        lines = [json.loads(line) for line in run(*detect, "--json", "--csv", answers).stdout.splitlines()]
        alone = [json.loads(line) for line in run(SEXTANT, "detect", models[0 if rest == 0 else 1], *detect[4:],
                                                  "--json").stdout.splitlines()]
        right = 0
        for line, single in zip(lines, alone):
            check(len(line["detections"]) == 1 and len(line["objects"]) == 2, f"one answer of two models: {line}")
            if not line["detections"] or not single["detections"]:
                continue
            best, only = line["detections"][0], single["detections"][0]
            check(best["log_score"] >= only["log_score"], "the better resting pose answers")
            if best["name"] == ("printed_box" if rest == 0 else "printed_box.rest2"):
                right += 1
                check(best["camera_from_object"] == only["camera_from_object"], "the pose is the model's own")
                check(best["runner_up_margin"] <= only["runner_up_margin"], "another resting pose is a rival")
            statuses.append(best["status"])
        check(right >= 3, f"resting pose {rest} is recognised in only {right} of 4")
        rows = list(csv.DictReader(answers.open()))
        check(len(rows) == 4 and all(int(r["obj_id"]) == 1 for r in rows), "rows of one object")
        truth = json.loads((scene / "test/000001/scene_gt.json").read_text())
        near = 0
        for row in rows:
            t = [float(v) for v in row["t"].split()]
            r = [float(v) for v in row["R"].split()]
            gt = truth[row["im_id"]][0]
            centre = (0, 0, 105)
            point = [[sum(m[3 * i + k] * centre[k] for k in range(3)) + v[i] for i in range(3)]
                     for m, v in ((r, t), (gt["cam_R_m2c"], gt["cam_t_m2c"]))]
            near += math.dist(*point) < 15
        check(near >= 3, f"resting pose {rest}: only {near} of 4 within 15 mm, in the mesh's own frame")
    check("optimal" in statuses, f"the answer can be optimal: {statuses}")


with tempfile.TemporaryDirectory() as name:
    main(Path(name))
print(f"{'failed' if failures else 'passed'}: {len(failures)} failures")
sys.exit(1 if failures else 0)
