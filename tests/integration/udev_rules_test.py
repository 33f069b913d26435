#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The shipped udev rules are what udev reads: known keys, known operators, a group for every node a camera needs."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOKEN = re.compile(r'^(SUBSYSTEM|GROUP|MODE|TAG)(==|\+=|=)"([A-Za-z0-9_]+)"$')


def main():
    subsystems = set()
    for number, line in enumerate((ROOT / "config" / "60-sextant-cameras.rules").read_text().splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        rule = {}
        for token in line.split(","):
            match = TOKEN.match(token.strip())
            if not match:
                sys.exit("line %d: udev would not read %r" % (number, token))
            key, operator, value = match.groups()
            if (operator == "==") != (key == "SUBSYSTEM"):
                sys.exit("line %d: %s%s" % (number, key, operator))
            rule[key] = value
        if rule.get("GROUP") != "video" or rule.get("MODE") != "0660":
            sys.exit("line %d: no access for the group video" % number)
        subsystems.add(rule["SUBSYSTEM"])
    if not {"video4linux", "media", "dma_heap"} <= subsystems:
        sys.exit("rules only for %s" % sorted(subsystems))
    print("udev rules for", sorted(subsystems))


if __name__ == "__main__":
    main()
