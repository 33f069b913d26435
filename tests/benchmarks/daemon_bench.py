#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What sextantd costs a robot: size, memory, start, end, and what becomes of a camera of 30 Hz.

    daemon_bench.py BIN_FOLDER MODEL... [--width PIXELS] [--seconds S] [--starts N] [--deadline-ms MS]
Plays the bundled sample at 30 Hz over loopback to one subscriber. Prints one line per figure.
"""
import argparse
import json
import os
import signal
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def size_of(program, folder):
    stripped = Path(folder) / program.name
    subprocess.run(["strip", "-o", stripped, program], check=True)
    return stripped.stat().st_size


def libraries_of(program):
    """(own, foreign): shared libraries by where they come from."""
    lines = subprocess.run(["ldd", program], check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
    paths = [line.split("=>")[1].split()[0] for line in lines if "=> /" in line]
    own = [path for path in paths if not path.startswith(("/lib/", "/usr/lib/"))]
    return own, [path for path in paths if path not in own]


def memory_kib(pid, key):
    for line in Path("/proc/%d/status" % pid).read_text().splitlines():
        if line.startswith(key + ":"):
            return int(line.split()[1])
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=Path)
    parser.add_argument("models", nargs="+", type=Path)
    parser.add_argument("--width", type=int, default=0, help="detect.search_width")
    parser.add_argument("--deadline-ms", type=float, default=0, help="detect.deadline_ms")
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--starts", type=int, default=5)
    arguments = parser.parse_args()
    daemon, cli = arguments.bin / "sextantd", arguments.bin / "sextant"
    domain = 1 + os.getpid() % 200
    env = {**os.environ, "CYCLONEDDS_URI": "file://%s/config/cyclonedds.xml" % ROOT}
    with tempfile.TemporaryDirectory() as folder:
        own, foreign = libraries_of(daemon)
        print("program, stripped: %.2f MB; shared libraries of ours: %d; Debian's: %d" %
              (1e-6 * size_of(daemon, folder), len(own), len(foreign)))
        config = Path(folder) / "sextantd.yaml"
        config.write_text("""
source: {kind: playback, dataset: "%s/data/sample", loop: true, rate_hz: 30}
models: {files: %s}
detect: {angle_tolerance_deg: 4, search_width: %d, deadline_ms: %g}
publish: {domain: %d}
log: {level: debug}
""" % (ROOT, json.dumps([str(m.resolve()) for m in arguments.models]), arguments.width, arguments.deadline_ms, domain))

        starts, ends, resident = [], [], []
        for i in range(arguments.starts):
            listener = subprocess.Popen([cli, "echo", "--domain", str(domain), "--topic", "diagnostics", "--json"],
                                        stdout=subprocess.PIPE, text=True, env=env)
            begin = time.monotonic()
            process = subprocess.Popen([daemon, "--config", config], stderr=subprocess.PIPE, text=True, env=env)
            for line in process.stderr:
                if "debug frame" in line and " 0 poses" not in line:
                    break
            starts.append(time.monotonic() - begin)
            os.set_blocking(process.stderr.fileno(), True)
            drain = subprocess.Popen(["cat"], stdin=process.stderr, stdout=subprocess.DEVNULL)
            last = i == arguments.starts - 1
            time.sleep(arguments.seconds if last else 1)
            resident.append((memory_kib(process.pid, "VmRSS"), memory_kib(process.pid, "VmHWM")))
            if last:
                for _ in range(2):
                    health = json.loads(listener.stdout.readline())
                # The newest of those that wait.
                os.set_blocking(listener.stdout.fileno(), False)
                for line in listener.stdout.read().splitlines():
                    if line.endswith("}"):
                        health = json.loads(line)
            listener.terminate()
            asked = time.monotonic()
            process.send_signal(signal.SIGTERM)
            code = process.wait()
            ends.append(time.monotonic() - asked)
            if code != 0:
                raise SystemExit("sextantd ended with %d" % code)
            drain.wait()
            listener.wait()
    print("from start to the first published pose: median %.2f s, worst %.2f s of %d" %
          (statistics.median(starts), max(starts), len(starts)))
    print("SIGTERM to the end: median %.2f s, worst %.2f s" % (statistics.median(ends), max(ends)))
    print("resident: %.0f MB, at most %.0f MB" % (resident[-1][0] / 1024, resident[-1][1] / 1024))
    for part in health["status"]:
        print("%s: %s" % (part["name"], part["message"]))
        if part["name"] == "sextantd: latency":
            values = part["values"]
            print("  median ms:", ", ".join("%s %.1f" % (key[:-len("_ms_median")], float(value))
                                            for key, value in values.items() if key.endswith("_ms_median")))
        if part["name"] == "sextantd: pipeline":
            print("  rate: %s Hz" % part["values"]["rate_hz"])


if __name__ == "__main__":
    main()
