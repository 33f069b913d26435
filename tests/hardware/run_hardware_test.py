#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the hardware tests on real kernel drivers: one boot of a machine with virtual cameras (vivid).

With --sextant the RGB-D frame that came through the virtual cameras is searched, on the host (an interpreted search
would take minutes), and the pose must be the data set's.

usage: run_hardware_test.py HARDWARE_TEST BUILD_FOLDER [--sextant PROGRAM] [--repeat N] [--filter PATTERN]
                            [--before SCRIPT] [--vimc] [--soak SECONDS] [--need]
Exit code 77 (skipped, with the reason printed) where QEMU, the kernel's package or the network is missing; with
--need (or SEXTANT_NEED_HARDWARE=1) that is a failure.
"""
import argparse
import fcntl
import json
import math
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "vm"))

from kernel import Kernel, Missing  # noqa: E402
from machine import Machine  # noqa: E402
from vimc import add_vimc, udev_lines  # noqa: E402

# Two HDMI loop-back pairs and two webcams (tests/hardware/vivid.h), all without audio, radio and the like.
VIVID = ("vivid n_devs=4 node_types=0x101,0x101,0x1,0x1 num_inputs=1,1,1,1 input_types=3,3,0,0 num_outputs=1,1,0,0 "
         "output_types=1,1 vid_cap_nr=0,1,2,3 vid_out_nr=10,11 multiplanar=1,1,1,2")


def script(kernel, arguments, job):
    lines = ["set -e", "export HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8",
             "modules=%s" % shlex.quote(str(kernel.root)),
             "export SEXTANT_SOAK_SECONDS=%d" % arguments.soak,
             "export SEXTANT_HARDWARE_OUT=%s" % shlex.quote(str(job)),
             "modprobe -d $modules -S %s %s" % (kernel.version, VIVID)]
    if arguments.vimc:
        lines += ["modprobe -d $modules -S %s vimc" % kernel.version] + udev_lines(kernel.build)
    lines += ["cd %s" % shlex.quote(str(job))]
    if arguments.before:
        lines += [". %s" % shlex.quote(str(Path(arguments.before).resolve()))]
    lines += ["for i in $(seq %d); do" % arguments.repeat,
              "timeout %d %s --gtest_color=no --gtest_brief=1 --gtest_filter=%s || code=$?" % (
                  arguments.timeout, shlex.quote(str(Path(arguments.test).resolve())), shlex.quote(arguments.filter)),
              "[ -z \"$code\" ] || { echo \"round $i: exit code $code\"; exit $code; }", "done"]
    return "\n".join(lines) + "\n"


def is_right_pose(frames, sextant, build):
    """Searches the frame that the machine left; True where the object is found where the data set has it."""
    sample = HERE.parents[1] / "data/sample/test/000001"
    table = json.loads((sample / "scene_table.json").read_text())["0"]
    truth = json.loads((sample / "scene_gt.json").read_text())["0"][0]
    (frames / "camera.yaml").write_text(
        "{width: 640, height: 480, fx: 525, fy: 525, cx: 319.5, cy: 239.5, depth_scale_mm: 0.1, "
        "pitch_deg: %r, roll_deg: %r, height_m: %r}\n" % (
            math.degrees(table["pitch_rad"]), math.degrees(table["roll_rad"]), table["height_m"]))
    model = build / "box.sxm"
    if not model.exists() or model.stat().st_mtime < Path(sextant).stat().st_mtime:
        # A coarse model of the views that the sample has: quick to learn, good enough to find the box.
        (frames / "learning.yaml").write_text("{min_pitch_deg: 38, max_pitch_deg: 40, max_roll_deg: 0, "
                                              "angle_tolerance_deg: 3, images_per_bin: 24, scenes_per_bin: 12, grid: 40}\n")
        subprocess.run([sextant, "compile", str(HERE.parents[1] / "data/meshes/printed_box.obj"), "--units", "mm", "--up", "z",
                        "--object-id", "1", "--params", str(frames / "learning.yaml"), "-o", str(model)], check=True,
                       stdout=subprocess.DEVNULL)
    done = subprocess.run([sextant, "detect", str(model), "--color", str(frames / "colour.png"), "--depth",
                           str(frames / "depth.png"), "--camera", str(frames / "camera.yaml"), "--angle-tolerance-deg", "4",
                           "--json"], stdout=subprocess.PIPE, text=True, check=True)
    detections = json.loads(done.stdout.splitlines()[0])["detections"]
    if not detections:
        print("FAILED: nothing was found in the frame that came through the cameras")
        return False
    pose = detections[0]["camera_from_object"]
    centre = (0, 0, 105)  # of the box, millimetres in its own frame
    found = [sum(pose[i][k] * centre[k] for k in range(3)) + 1000 * pose[i][3] for i in range(3)]
    wanted = [sum(truth["cam_R_m2c"][3 * i + k] * centre[k] for k in range(3)) + truth["cam_t_m2c"][i] for i in range(3)]
    error = math.dist(found, wanted)
    # The same box turned by half a turn has the same shape; only its print differs, which a coarse model may not tell.
    turns = [abs(sum(pose[i][k] * truth["cam_R_m2c"][3 * i + k] for i in range(3))) for k in (0, 2)]
    turn = max(math.degrees(math.acos(min(1, c))) for c in turns)
    good = error < 15 and turn < 10
    print("%s: the box is found %.1f mm and %.1f deg from where it is" % ("passed" if good else "FAILED", error, turn))
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("test")
    parser.add_argument("build")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--filter", default="*")
    parser.add_argument("--before", help="shell script that the machine sources before the tests")
    parser.add_argument("--timeout", type=int, default=240, help="seconds of one round")
    parser.add_argument("--sextant", help="the program, for a search in the frame that came through")
    parser.add_argument("--vimc", action="store_true", help="also libcamera's virtual camera (150 MB of kernel source)")
    parser.add_argument("--soak", type=int, default=0, help="seconds; then only the soak runs")
    parser.add_argument("--need", action="store_true")
    arguments = parser.parse_args()
    if arguments.soak:
        arguments.filter = "Soak.*"
        arguments.timeout += arguments.soak
    began = time.monotonic()
    try:
        folder = Path(arguments.build).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        # One run at a time: they share the kernel, the initramfs and the model. Held until this process ends.
        lock = (folder / "lock").open("w")
        fcntl.flock(lock, fcntl.LOCK_EX)
        kernel = Kernel(folder, HERE / "vm/init")
        machine = Machine(kernel)
        if arguments.vimc:
            add_vimc(kernel, folder)
    except Missing as reason:
        need = arguments.need or os.environ.get("SEXTANT_NEED_HARDWARE") == "1"
        print("%s: hardware tests need a virtual machine: %s" % ("FAILED" if need else "SKIPPED", reason))
        return 1 if need else 77
    # Not below /tmp, which the machine has for itself.
    job = Path(tempfile.mkdtemp(prefix="job-", dir=folder))
    try:
        text = script(kernel, arguments, job)
        code, console = machine.run(text, job, arguments.timeout * arguments.repeat + 60)
        print("kernel %s, %.0f s" % (kernel.version, time.monotonic() - began))
        found = not arguments.sextant or code != 0 or is_right_pose(job, arguments.sextant, folder)
    finally:
        shutil.rmtree(job, ignore_errors=True)
    if code is None:
        print("FAILED: the machine gave no exit code; its console ended with:\n" + console[-4000:])
        return 1
    if code != 0:
        print("FAILED with exit code %d; the kernel said:\n%s" % (code, console[-4000:]))
    return 0 if code == 0 and found else 1


if __name__ == "__main__":
    sys.exit(main())
