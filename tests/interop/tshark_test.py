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
    """The text of each announced writer, by topic."""
    found = {}
    for block in re.split(r"\n    submessageId: ", text):
        match = re.search(r"\n +topic: (rt/\S+)", block)
        if match and "ENTITYID_BUILTIN_PUBLICATIONS_WRITER" in block:
            found.setdefault(match.group(1), block)
    return found


def wrong_with(name, block):
    """What the dissector sees otherwise than the manual says. Defaults (reliable writer, volatile) are not sent."""
    type_name, durability = TOPICS[name]
    if "typeName: %s\n" % type_name not in block:
        yield "the type name is not " + type_name
    if "BEST_EFFORT_RELIABILITY_QOS" in block:
        yield "it is best-effort"
    if ("TRANSIENT_LOCAL_DURABILITY_QOS" in block) != (durability == "TRANSIENT_LOCAL"):
        yield "the durability is not " + durability
    if ("PID_LIFESPAN" in block) != (name == "pose_estimates"):
        yield "only pose_estimates has a lifespan"
    if ("PID_DEADLINE" in block) != (name == "detections"):
        yield "only detections has a deadline"
    if ("PID_LIVELINESS" in block) != (name in ("detections", "object_pose", "pose_estimates", "table_estimate")):
        yield "the topics that say where objects are, and only they, have a lease"
    if "userData: " + b"typehash=RIHS01_".hex() not in block:
        yield "no type hash"


def main():
    if not shutil.which("tshark"):
        skip("there is no tshark on this machine (apt-get install tshark)")
    domain, name_space = 1 + os.getpid() % 200, "shark_%d" % os.getpid()
    with tempfile.TemporaryDirectory() as folder:
        text = capture(folder, domain, name_space)
    if "--print" in sys.argv:
        print(text)
    found, failures = announcements(text), []
    for name in TOPICS:
        block = found.get("rt/%s/%s" % (name_space, name))
        if block is None:
            failures.append("%s is not announced (seen: %s)" % (name, sorted(found)))
            continue
        failures += ["%s: %s" % (name, wrong) for wrong in wrong_with(name, block)]
    if "Malformed Packet" in text:
        failures.append("the dissector calls a packet malformed")
    if text.count("[topic: rt/%s/detections]" % name_space) < 10:
        failures.append("the data of detections were not seen")
    for failure in failures:
        print("FAILED:", failure)
    print("%d endpoints seen by tshark, %d failures" % (len(found), len(failures)))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
