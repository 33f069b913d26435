#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs sextantd as a service of a real systemd: config/sextantd.service, installed as docs/run-on-your-robot.md says.

    run_systemd_test.py SEXTANTD SEXTANT BUILD_FOLDER [--need]
One boot of the test machine (tests/hardware/vm) with systemd as PID 1: start, own user and rights, reload, kill, stuck
(watchdog), bad configuration, orderly stop. Exit code 77 (skipped, with the reason printed) where QEMU, systemd or the
kernel's package is missing; with --need that is a failure.
"""
import argparse
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE / "vm"))

from kernel import Kernel, Missing, need  # noqa: E402
from machine import Machine  # noqa: E402

# Instructions are interpreted in the machine, so a search of this size has a deadline: frames must pass, poses need not.
CONFIG = """
source: {kind: playback, dataset: "/etc/sextant/sample", loop: true, rate_hz: 1}
models: {files: ["models/*.sxm"]}
detect: {angle_tolerance_deg: 4, search_width: 160, deadline_ms: 200}
pipeline: {max_age_ms: 60000}
publish: {domain: 5}
"""

JOB = r"""
export PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 HOME=/root
export CYCLONEDDS_URI=file:///etc/sextant/cyclonedds.xml
failed=0
fail() { echo "FAILED: $*"; failed=1; }
pass() { echo "passed: $*"; }
check() { what=$1; shift; if "$@"; then pass "$what"; else fail "$what"; fi; }
show() { systemctl show -p "$1" --value sextantd; }
said() { for i in $(seq 60); do journalctl -u sextantd -o cat --no-pager | grep -q "$1" && return 0; sleep 0.5; done; return 1; }
becomes() { for i in $(seq 120); do [ "$(show "$1")" = "$2" ] && return 0; sleep 0.5; done; return 1; }
hears() { sextant echo --domain 5 --topic detections --count 1 --timeout-s 60 --require >/dev/null; }

install -m 755 @SEXTANTD@ /usr/bin/sextantd
install -m 755 @SEXTANT@ /usr/bin/sextant
install -d /etc/sextant /etc/sextant/models
cp -r @ROOT@/data/sample /etc/sextant/
cp @JOB@/box.sxm /etc/sextant/models/
install -m 644 @ROOT@/config/cyclonedds.xml /etc/sextant/
install -m 644 @ROOT@/config/sextantd.service /etc/systemd/system/
install -m 644 @JOB@/sextantd.yaml /etc/sextant/
# The shipped 30 s would only make the test slow.
install -d /run/systemd/system/sextantd.service.d
printf '[Service]\nWatchdogSec=8\n' >/run/systemd/system/sextantd.service.d/quick.conf
systemctl daemon-reload

check "starts, and is ready only with configuration and models" systemctl start sextantd
check "is active" systemctl -q is-active sextantd
pid=$(show MainPID)
status() { sed -n "s/^$1:[[:space:]]*//p" /proc/$pid/status; }
echo "it runs as uid $(status Uid | cut -f1), groups $(status Groups), seccomp $(status Seccomp), capabilities $(status CapEff)"
[ "$(status Uid | cut -f1)" -ge 61184 ] || fail "a user of its own"
check "no new privileges" [ "$(status NoNewPrivs)" = 1 ]
check "no capability" [ "$(status CapBnd)" = 0000000000000000 ]
check "system calls are filtered" [ "$(status Seccomp)" = 2 ]
video=$(getent group video | cut -d: -f3)
check "in the video group" grep -q "^Groups:.*\b$video\b" /proc/$pid/status
check "sees a read-only system" sh -c "! nsenter -t $pid -m touch /usr/x /etc/sextant/x 2>/dev/null"
check "sees no home folders" sh -c "mkdir -p /home/somebody; [ -z \"\$(nsenter -t $pid -m ls -A /home 2>/dev/null)\" ]"
check "poses come over DDS" hears

systemctl reload sextantd
check "reload reads models and configuration again" said "SIGHUP: models read again"
echo "nonsense: {}" >>/etc/sextant/sextantd.yaml
systemctl reload sextantd
check "reload of a bad file changes nothing and says so" said "SIGHUP: nothing has changed: .*nonsense"
check "and goes on" [ "$(show MainPID)" = "$pid" ]
sed -i /nonsense/d /etc/sextant/sextantd.yaml

kill -9 $pid
check "after kill -9 systemd starts it again" becomes NRestarts 1
check "and poses come again" hears

kill -STOP $(show MainPID)
check "one that hangs is found by the watchdog and started again" becomes NRestarts 2
check "and systemd says why" sh -c "dmesg | grep -q 'sextantd.service: Watchdog timeout'"
check "and poses come again" hears

systemctl stop sextantd
check "stops in order" [ "$(show Result)" = success -a "$(show ExecMainStatus)" = 0 ]
check "its last word" said "frames published"

echo "nonsense: {}" >>/etc/sextant/sextantd.yaml
systemctl start sextantd && fail "a bad file was accepted"
check "a bad file is exit code 3 and no reason to try again" [ "$(show ExecMainStatus)" = 3 -a "$(show ActiveState)" = failed ]
sed -i /nonsense/d /etc/sextant/sextantd.yaml

# A network that is not there yet: started all the same, waits, says so.
printf '[Service]\nEnvironment=CYCLONEDDS_URI=file:///etc/sextant/later.xml\n' >/run/systemd/system/sextantd.service.d/network.conf
sed 's/name="lo"/name="robot0"/' /etc/sextant/cyclonedds.xml >/etc/sextant/later.xml
systemctl daemon-reload
systemctl reset-failed sextantd
check "starts without its network" systemctl start sextantd
check "and says that it waits" said "waiting: DDS"
systemctl status sextantd --no-pager | grep Status
cp /etc/sextant/cyclonedds.xml /etc/sextant/later.xml
check "and goes on when it comes" hears
systemctl stop sextantd
[ $failed = 0 ] || journalctl -u sextantd --no-pager | tail -100
exit $failed
"""


def script(arguments, job):
    text = JOB
    for name, value in (("SEXTANTD", Path(arguments.sextantd).resolve()), ("SEXTANT", Path(arguments.sextant).resolve()),
                        ("ROOT", ROOT), ("JOB", job)):
        text = text.replace("@%s@" % name, shlex.quote(str(value)))
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sextantd")
    parser.add_argument("sextant")
    parser.add_argument("build")
    parser.add_argument("--need", action="store_true")
    arguments = parser.parse_args()
    began = time.monotonic()
    try:
        if not Path("/lib/systemd/systemd").exists():
            raise Missing("there is no /lib/systemd/systemd (Debian package systemd)")
        for program, package in (("journalctl", "systemd"), ("nsenter", "util-linux")):
            need(program, package)
        folder = Path(arguments.build).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        kernel = Kernel(folder, HERE / "vm/init")
        machine = Machine(kernel)
    except Missing as reason:
        print("%s: the service's test needs a virtual machine: %s" % ("FAILED" if arguments.need else "SKIPPED", reason))
        return 1 if arguments.need else 77
    job = Path(tempfile.mkdtemp(prefix="job-", dir=folder))
    try:
        (job / "learning.yaml").write_text("{min_pitch_deg: 38, max_pitch_deg: 40, max_roll_deg: 0, angle_tolerance_deg: 3, "
                                           "images_per_bin: 10, grid: 24}\n")
        subprocess.run([arguments.sextant, "compile", str(ROOT / "data/meshes/printed_box.obj"), "--units", "mm", "--up", "z",
                        "--object-id", "1", "--params", str(job / "learning.yaml"), "-o", str(job / "box.sxm")], check=True,
                       stdout=subprocess.DEVNULL)
        (job / "sextantd.yaml").write_text(CONFIG)
        code, console = machine.run(script(arguments, job), job, 540, systemd=True)
    finally:
        shutil.rmtree(job, ignore_errors=True)
    print("kernel %s, %.0f s" % (kernel.version, time.monotonic() - began))
    if code != 0:
        print("FAILED with exit code %s; the console ended with:\n%s" % (code, console[-4000:]))
    return 0 if code == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
