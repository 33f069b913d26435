#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Soak: sextantd at 30 Hz with two subscribers, one of them slow, for SECONDS (scripts/test --long: 900).

    soak.py BIN_FOLDER SOURCE_FOLDER [SECONDS [MODEL]]
Without MODEL (a compiled printed_box) a coarse one is learned first.
Checks that memory is constant after the first tenth, that every frame of the source is accounted for (published, or
reported as late, stale or dropped), that the fast subscriber gets everything that is published, that no age is above
the configured maximum, and that the daemon ends within a second.
"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

BIN, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
SECONDS = float(sys.argv[3]) if len(sys.argv) > 3 else 900.0
MODEL = Path(sys.argv[4]).resolve() if len(sys.argv) > 4 else None
RATE_HZ, MAX_AGE_MS = 30, 500
GROWTH_KIB = 3072  # allocators settle; a leak of one frame's result per second would show
# A coarse model of the views that the sample has.
LEARNING = "min_pitch_deg: 40\nmax_pitch_deg: 42\nmax_roll_deg: 0\nangle_tolerance_deg: 3\nimages_per_bin: 24\nscenes_per_bin: 12\ngrid: 40\n"
failures = []


def check(good, what):
    if not good:
        failures.append(what)
        print("FAILED:", what, flush=True)


def resident_kib(pid):
    for line in Path("/proc/%d/status" % pid).read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    return 0


def read_lines(path):
    return [json.loads(line) for line in path.read_text().splitlines() if line.endswith("}")]


def main():
    with tempfile.TemporaryDirectory() as name:
        return run(Path(name))


def run(folder):
    domain = 1 + os.getpid() % 200
    env = {**os.environ, "CYCLONEDDS_URI": "file://%s/config/cyclonedds.xml" % SOURCE}
    model = MODEL or folder / "box.sxm"
    if not MODEL:
        (folder / "learning.yaml").write_text(LEARNING)
        subprocess.run([BIN / "sextant", "compile", SOURCE / "data/meshes/printed_box.obj", "--units", "mm", "--up", "z",
                        "--object-id", "1", "--params", folder / "learning.yaml", "-o", model], check=True)
    (folder / "sextantd.yaml").write_text(f"""
source: {{kind: playback, dataset: "{SOURCE}/data/sample", loop: true, rate_hz: {RATE_HZ}}}
models: {{files: ["{model}"]}}
detect: {{angle_tolerance_deg: 4, search_width: 320, deadline_ms: 15}}
publish: {{domain: {domain}}}
pipeline: {{max_age_ms: {MAX_AGE_MS}}}
""")
    fast_file, slow_file, health_file = (folder / n for n in ("fast.json", "slow.json", "health.json"))

    def echo(topic, out):
        return subprocess.Popen([BIN / "sextant", "echo", "--domain", str(domain), "--topic", topic, "--json"],
                                stdout=out.open("w"), env=env)
    # Daemon last: the listeners are there before the first frame.
    listeners = [echo("pose_estimates", fast_file), echo("detections", slow_file), echo("diagnostics", health_file)]
    slow = listeners[1]
    daemon = subprocess.Popen([BIN / "sextantd", "--config", folder / "sextantd.yaml"], stderr=(folder / "log").open("w"),
                              env=env)
    memory = []
    start = time.monotonic()
    while time.monotonic() - start < SECONDS and daemon.poll() is None:
        # The slow subscriber sleeps most of the time.
        slow.send_signal(signal.SIGSTOP)
        time.sleep(4)
        slow.send_signal(signal.SIGCONT)
        time.sleep(1)
        if daemon.poll() is None:
            memory.append((time.monotonic() - start, resident_kib(daemon.pid)))
    check(daemon.poll() is None, "the daemon ended by itself: " + (folder / "log").read_text()[-1000:])
    time.sleep(1)
    asked = time.monotonic()
    daemon.terminate()
    code = daemon.wait(timeout=10)
    took = time.monotonic() - asked
    check(code == 0 and took < 1, "SIGTERM: exit code %s after %.2f s" % (code, took))
    time.sleep(1)
    for listener in listeners:
        listener.terminate()
        listener.wait(timeout=10)
    report(folder, memory, fast_file, slow_file, health_file)
    return 1 if failures else 0


def report(folder, memory, fast_file, slow_file, health_file):
    settled = [kib for at, kib in memory if at >= memory[-1][0] / 10] if memory else []
    if settled:
        growth = settled[-1] - settled[0]
        print("memory: %d KiB after the first tenth, %d KiB at the end, highest %d KiB" %
              (settled[0], settled[-1], max(settled)))
        check(growth <= GROWTH_KIB, "memory grew by %d KiB" % growth)
    last = [line for line in (folder / "log").read_text().splitlines() if "frames published" in line][-1]
    print("daemon:", last.split("info ")[-1])
    numbers = [int(word) for word in last.replace("(", " ").replace(",", " ").split("info ")[-1].split() if word.isdigit()]
    published = numbers[0]
    got = read_lines(fast_file)
    ages = sorted(m["age_s"] for m in got)
    check(len(got) >= 0.999 * published, "the fast subscriber got %d of %d" % (len(got), published))
    check(published > 0 and ages[-1] <= MAX_AGE_MS / 1000 + 0.1, "an age of %.3f s was published" % (ages[-1] if ages else -1))
    print("fast subscriber: %d messages, age median %.1f ms, 95 %% %.1f ms, worst %.1f ms" %
          (len(got), 1e3 * ages[len(ages) // 2], 1e3 * ages[int(0.95 * len(ages))], 1e3 * ages[-1]))
    # Every frame of the source is published or reported.
    lost, sequence = 0, [m["frame_number"] for m in got]
    for before, after in zip(sequence, sequence[1:]):
        lost += after - before - 1
    health = read_lines(health_file)[-1]["status"]
    pipeline = next(s for s in health if s["name"] == "sextantd: pipeline")["values"]
    told = sum(int(pipeline[k]) for k in ("dropped_waiting", "dropped_unpublished", "stale", "too_old", "failed"))
    print("frames that did not come: %d, reported: %d; slow subscriber: %d messages; rate %s Hz" %
          (lost, told, len(read_lines(slow_file)), pipeline["rate_hz"]))
    check(lost <= told + 3, "%d frames did not come, only %d are reported" % (lost, told))


if __name__ == "__main__":
    sys.exit(main())
