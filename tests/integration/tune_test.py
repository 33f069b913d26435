#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""sextant tune as a user runs it, and over MPI ranks: the same answers; a stopped run goes on; its file compiles."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

BIN, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
MESH = [SOURCE / "data/meshes/tea_box.obj", "--units", "mm", "--up", "z"]
PARAMETERS = """min_pitch_deg: 38
max_pitch_deg: 40
max_roll_deg: 0
angle_tolerance_deg: 2
images_per_bin: 10
scenes_per_bin: 4
grid: 32
bin_width_deg: 40
camera_width: 160
camera_height: 120
camera_focal: 131
camera_cx: 79.5
camera_cy: 59.5
"""
failures = []


def check(condition, what):
    if not condition:
        failures.append(what)
        print("FAILED:", what)


def run(*command, expect=0, env=None):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=500, env={**os.environ, **(env or {})})
    check(done.returncode == expect, f"exit {done.returncode}, expected {expect}: {' '.join(map(str, command))}\n"
          f"{done.stdout[-1500:]}{done.stderr[-1500:]}")
    return done


def without_times(answer):
    """All but what the clock says."""
    for score in [*answer["points"], *answer["held_out"].values()]:
        del score["seconds"]
    return answer


def main(folder):
    parameters, scenes = folder / "learning.yaml", folder / "scenes"
    parameters.write_text(PARAMETERS)
    run(BIN / "sextant", "synthesize", *MESH, "-o", scenes, "--images", 4, "--negatives", 1, "--size", "160x120", "--focal", 131,
        "--pitch-deg", "38:40", "--roll-deg", "0:0", "--sensor", "kinect1", "--seed", 5)
    options = [*MESH, "--dataset", scenes, "--params", parameters, "--sweep", "depth_parts=40", "height_tolerance_m=0.005,0.02",
               "--metric", "right", "--json"]

    first = folder / "one"
    answer = json.loads(run(BIN / "sextant", "tune", *options, "-o", first).stdout)
    check(len(answer["points"]) >= 4, "defaults and three values")
    check(answer["points"][0]["parameters"] == {}, "the defaults come first")
    check(answer["points"][0]["images"] == 3, "two of four images, one of one negative")
    check(answer["held_out"]["best"]["images"] == 2, "the held-out half")
    for file in ("tuned.yaml", "report.html"):
        check((first / file).exists(), file)

    # What was answered is not asked again: a stopped run loses at most one trial.
    kept = {f: f.stat().st_mtime_ns for f in (first / "trials").iterdir()}
    lost = sorted(kept)[0]
    lost.unlink()
    again = json.loads(run(BIN / "sextant", "tune", *options, "-o", first).stdout)
    check(without_times(again) == without_times(answer), "the same after it went on")
    check(all(f.stat().st_mtime_ns == t for f, t in kept.items() if f != lost), "answers on file are kept")
    check(lost.exists(), "the lost one is made again")

    model = folder / "tuned.sxm"
    run(BIN / "sextant", "compile", *MESH, "--params", first / "tuned.yaml", "-o", model)
    check(model.exists(), "tuned.yaml compiles")

    run(BIN / "sextant", "tune", *options[:-3], "--sweep", "no_such=1", "-o", folder / "x", expect=2)
    run(BIN / "sextant", "tune", *MESH, "--dataset", folder / "nothing", "--sweep", "grid=32", "-o", folder / "x", expect=3)

    if not shutil.which("mpirun") or not (BIN / "sextant-mpi").exists():
        print("no mpirun or no sextant-mpi: the MPI part is skipped")
        return
    ranks = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    spread = json.loads(run("mpirun", "--oversubscribe", "-n", 2, BIN / "sextant-mpi", "tune", *options, "-o", folder / "two",
                            env=ranks).stdout)
    check(without_times(spread) == answer, "two ranks answer like one process")


with tempfile.TemporaryDirectory(prefix="sextant_tune_") as name:
    main(Path(name))
print("ok" if not failures else f"{len(failures)} failures")
sys.exit(1 if failures else 0)
