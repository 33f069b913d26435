#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The main job as a user runs it: mesh -> model -> poses in files and over DDS, and the documented exit codes."""
import csv
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

BIN, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
MESHES, SAMPLE = SOURCE / "data/meshes", SOURCE / "data/sample"
# A coarse model of the views that the sample has: quick to learn, good enough to find the box.
PARAMETERS = """min_pitch_deg: 40
max_pitch_deg: 42
max_roll_deg: 0
angle_tolerance_deg: 3
images_per_bin: 24
scenes_per_bin: 12
grid: 40
"""
failures = []


def check(condition, what):
    if not condition:
        failures.append(what)
        print("FAILED:", what)


def run(*command, expect=0, env=None):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=500,
                          env={**os.environ, **(env or {})})
    check(done.returncode == expect, f"exit {done.returncode}, expected {expect}: {' '.join(map(str, command))}\n"
          f"{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done


def ground_truth():
    table = {}
    for image, objects in json.loads((SAMPLE / "test/000001/scene_gt.json").read_text()).items():
        table[int(image)] = objects[0]
    return table


def centre_error_mm(rotation, translation, truth, centre=(0, 0, 105)):
    def at(r, t):
        return [sum(r[3 * i + k] * centre[k] for k in range(3)) + t[i] for i in range(3)]
    return math.dist(at(rotation, translation), at(truth["cam_R_m2c"], truth["cam_t_m2c"]))


def main_job(folder):
    parameters = folder / "learning.yaml"
    parameters.write_text(PARAMETERS)
    model = folder / "box.sxm"
    run(BIN / "sextant", "compile", MESHES / "printed_box.obj", "--units", "mm", "--up", "z", "--object-id", 1,
        "--params", parameters, "-o", model)
    csv_file, overlay = folder / "poses.csv", folder / "overlay"
    done = run(BIN / "sextant", "detect", model, "--dataset", SAMPLE, "--csv", csv_file, "--overlay", overlay,
               "--angle-tolerance-deg", 4, "--json")
    truth = ground_truth()
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    check(len(lines) == len(truth), "one JSON line per image")
    for line in lines:
        check(set(line) >= {"scene_id", "im_id", "seconds", "nodes", "objects", "detections"}, "JSON keys")
        outcome = line["objects"][0]
        check(len(line["detections"]) + outcome["doubtful"] == 1, "an answer is given or withheld as doubtful")
        for found in line["detections"]:
            check(found["status"] == "optimal", "a completed search is optimal")
            check(found["gap"] == 0, "an optimal answer has no gap")
            check(outcome["upper_bound"] <= found["log_score"], "bound of the rest")
    rows = list(csv.DictReader(csv_file.open()))
    check(len(rows) == sum(len(line["detections"]) for line in lines), "one row per answer")
    right = 0
    for row in rows:
        rotation, translation = ([float(v) for v in row[k].split()] for k in ("R", "t"))
        right += centre_error_mm(rotation, translation, truth[int(row["im_id"])]) < 15
    check(right >= len(truth) - 1, f"only {right} of {len(truth)} poses within 15 mm")
    check(len(list(overlay.glob("*.png"))) == len(truth), "one picture per image")

    # The same model and frames at another number of threads: the same bits.
    again = folder / "again.csv"
    run(BIN / "sextant", "detect", model, "--dataset", SAMPLE, "--csv", again, "--angle-tolerance-deg", 4,
        "--threads", 3)
    strip = lambda file: [{k: v for k, v in row.items() if k != "time"} for row in csv.DictReader(file.open())]
    check(strip(again) == strip(csv_file), "threads change the answer")

    # Far above the best score there is provably nothing.
    none = run(BIN / "sextant", "detect", model, "--dataset", SAMPLE, "--image", 0, "--threshold", 100000, "--json",
               "--require", expect=1)
    check(json.loads(none.stdout)["objects"][0]["status"] == "absent", "absence is proven")
    return model


def over_dds(folder, model):
    domain = 30 + os.getpid() % 150
    config = folder / "sextantd.yaml"
    config.write_text(f"""source: {{kind: playback, dataset: "{SAMPLE}", loop: true}}
models: {{files: ["{model}"]}}
detect: {{angle_tolerance_deg: 4}}
publish: {{domain: {domain}}}
""")
    env = {"CYCLONEDDS_URI": f"file://{SOURCE}/config/cyclonedds.xml"}
    daemon = subprocess.Popen([str(BIN / "sextantd"), "--config", str(config)], stderr=subprocess.PIPE, text=True,
                              env={**os.environ, **env})
    try:
        echo = run(BIN / "sextant", "echo", "--domain", domain, "--count", 2, "--timeout-s", 60, "--require", "--json",
                   env=env)
        for line in echo.stdout.splitlines():
            check("printed_box" in line, "the pose of the box arrives: " + line[:300])
    finally:
        daemon.terminate()
        check(daemon.wait(timeout=10) == 0, "sextantd ends cleanly")
        daemon.stderr.close()


def bad_use(folder, model):
    sextant = BIN / "sextant"
    run(sextant, expect=2)
    run(sextant, "detect", model, expect=2)
    run(sextant, "detect", model, "--dataset", SAMPLE, "--scoring", "magic", expect=2)
    run(sextant, "detect", model, "--dataset", SAMPLE, "--table", "40", expect=2)
    run(sextant, "detect", model, "--dataset", folder / "nothing", expect=3)
    run(sextant, "detect", MESHES / "mug.stl", "--dataset", SAMPLE, expect=3)
    run(sextant, "compile", folder / "no.ply", "-o", folder / "x.sxm", expect=3)
    run(sextant, "compile", MESHES / "mug.stl", "-o", folder / "x.sxm", expect=3)  # millimetres read as metres
    run(sextant, "compile", MESHES / "mug.stl", "--units", "mm", "--pitch-deg", "lots", "-o", folder / "x.sxm", expect=2)
    damaged = folder / "damaged.sxm"
    damaged.write_bytes(model.read_bytes()[:-7])
    done = run(sextant, "detect", damaged, "--dataset", SAMPLE, expect=3)
    check(done.stderr.count("\n") == 1 and "damaged.sxm" in done.stderr, "one clear line: " + done.stderr)


with tempfile.TemporaryDirectory() as name:
    compiled = main_job(Path(name))
    over_dds(Path(name), compiled)
    bad_use(Path(name), compiled)
print(f"{'failed' if failures else 'passed'}: {len(failures)} failures")
sys.exit(1 if failures else 0)
