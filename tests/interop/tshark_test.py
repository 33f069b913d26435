#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tshark's RTPS dissector as a referee: what our publisher announces on loopback, read by somebody else's decoder.

    tshark_test.py DDS_HELPER SOURCE_FOLDER
Exit 77 (skipped) where there is no tshark or it may not capture on the loopback interface.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HELPER, SOURCE = sys.argv[1], sys.argv[2]
TOPICS = {
    "detections": ("vision_msgs::msg::dds_::Detection3DArray_", "VOLATILE"),
    "object_pose": ("geometry_msgs::msg::dds_::PoseStamped_", "VOLATILE"),
    "pose_estimates": ("sextant_msgs::msg::dds_::PoseEstimateArray_", "TRANSIENT_LOCAL"),
    "tf": ("tf2_msgs::msg::dds_::TFMessage_", "VOLATILE"),
    "markers": ("visualization_msgs::msg::dds_::MarkerArray_", "VOLATILE"),
    "annotated/image_raw": ("sensor_msgs::msg::dds_::Image_", "VOLATILE"),
    "table_estimate": ("sextant_msgs::msg::dds_::TableEstimate_", "VOLATILE"),
    "diagnostics": ("diagnostic_msgs::msg::dds_::DiagnosticArray_", "VOLATILE"),
}


def skip(reason):
    print("SKIPPED:", reason)
    sys.exit(77)


def capture(folder, domain, name_space):
    """The dissector's text of everything that the helper said."""
    file = Path(folder) / "capture.pcap"
    ports = "udp portrange %d-%d" % (7400 + 250 * domain, 7400 + 250 * domain + 249)
    shark = subprocess.Popen(["tshark", "-q", "-i", "lo", "-f", ports, "-w", str(file)], stderr=subprocess.PIPE, text=True)
    line = ""
    while "Capturing" not in line:
        line = shark.stderr.readline()
        if not line or shark.poll() is not None:
            skip("tshark may not capture on the loopback interface: " + line.strip())
    time.sleep(1)  # tshark says "Capturing" a moment before it does
    uri = ("file://%s/config/cyclonedds.xml,<CycloneDDS><Domain Id=\"%d\"><Discovery><ExternalDomainId>%d"
           "</ExternalDomainId></Discovery></Domain></CycloneDDS>" % (SOURCE, domain + 1, domain))
    subprocess.run([HELPER, "publish", str(domain), name_space, "4"], check=True, env={**os.environ, "CYCLONEDDS_URI": uri})
    shark.terminate()
    shark.communicate(timeout=20)
    return subprocess.run(["tshark", "-r", str(file), "-V", "-Y", "rtps"], capture_output=True, text=True, check=True).stdout


def announcements(text):
    """The text of each announced endpoint, by topic."""
    found = {}
    for block in re.split(r"\n    submessageId: ", text):
        match = re.search(r"topic: (rt/\S+)", block, re.I) or re.search(r"PID_TOPIC_NAME.*?(rt/[\w/]+)", block, re.S)
        if match and "DATA(w)" in block:
            found.setdefault(match.group(1), block)
    return found


def main():
    if not shutil.which("tshark"):
        skip("there is no tshark on this machine (apt-get install tshark)")
    domain, name_space = 1 + os.getpid() % 200, "shark_%d" % os.getpid()
    with tempfile.TemporaryDirectory() as folder:
        text = capture(folder, domain, name_space)
    if "--print" in sys.argv:
        print(text)
    found, failures = announcements(text), []
    for name, (type_name, durability) in TOPICS.items():
        block = found.get("rt/%s/%s" % (name_space, name))
        if block is None:
            failures.append("%s is not announced (seen: %s)" % (name, sorted(found)))
            continue
        for needed in (type_name, "RELIABLE_RELIABILITY_QOS", durability + "_DURABILITY_QOS"):
            if needed not in block:
                failures.append("%s: the dissector does not see %s" % (name, needed))
    if "Malformed Packet" in text:
        failures.append("the dissector calls a packet malformed")
    if not re.search(r"DATA[^\n]*\(0x15\)", text):
        failures.append("no data were seen")
    for failure in failures:
        print("FAILED:", failure)
    print("%d endpoints seen by tshark, %d failures" % (len(found), len(failures)))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
