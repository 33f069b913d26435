#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""config/sextantd.service as systemd reads it: no complaint from systemd-analyze verify.

    service_test.py SEXTANTD
The program is not installed where the unit expects it, so a copy of the unit names the built one. Exit 77
(skipped) where there is no systemd-analyze.
"""
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
INSTALLED = "/usr/bin/sextantd"


def verify(unit_text, folder):
    unit = Path(folder) / "sextantd.service"
    unit.write_text(unit_text, encoding="utf-8")
    run = subprocess.run(["systemd-analyze", "verify", "--man=no", str(unit)], capture_output=True, text=True)
    complaints = [line for line in run.stderr.splitlines() if "sextantd" in line]
    return run.returncode, complaints, run.stderr


def main():
    if not shutil.which("systemd-analyze"):
        print("SKIPPED: there is no systemd-analyze on this machine")
        return 77
    text = (ROOT / "config" / "sextantd.service").read_text(encoding="utf-8")
    for needed in ("Type=notify", "WatchdogSec=", "ExecStart=" + INSTALLED):
        if needed not in text:
            print("FAILED: the unit lacks", needed)
            return 1
    with tempfile.TemporaryDirectory() as folder:
        code, complaints, stderr = verify(text.replace(INSTALLED, sys.argv[1]), folder)
        spoilt_code, spoilt, _ = verify(text.replace("ProtectHome=yes", "ProtectHouse=yes"), folder)
    if not spoilt and spoilt_code == 0:
        print("SKIPPED: this systemd-analyze accepts anything")
        return 77
    if code != 0 or complaints:
        print("FAILED:", code, stderr)
        return 1
    print("systemd-analyze verify: no complaint")
    return 0


if __name__ == "__main__":
    sys.exit(main())
