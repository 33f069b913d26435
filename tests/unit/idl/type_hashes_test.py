#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The .msg files, the .idl files and ROS 2 itself agree on every type.

The known hashes are those that ROS 2 (Jazzy) generates for these packages.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "idl" / "dds"))
sys.dont_write_bytecode = True
import type_hashes  # noqa: E402

KNOWN = {
    "builtin_interfaces/Time": "RIHS01_b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197",
    "geometry_msgs/PoseStamped": "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8",
    "std_msgs/Header": "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01",
    "tf2_msgs/TFMessage": "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "diagnostic_msgs/DiagnosticArray": "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
    "visualization_msgs/MarkerArray": "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf",
    "sensor_msgs/Image": "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
    "sensor_msgs/CompressedImage": "RIHS01_15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a",
    "sensor_msgs/CameraInfo": "RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275",
    "vision_msgs/Detection3D": "RIHS01_ddd703be132ab0b69d33121f1bb034132bfbb3b0ac5f9fb1516005ba1c8a265b",
    "vision_msgs/Detection3DArray": "RIHS01_793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018",
}
IDL_TYPES = {"long": "int32", "unsigned long": "uint32", "long long": "int64", "unsigned long long": "uint64",
             "double": "float64", "float": "float32", "octet": "uint8", "boolean": "bool", "string": "string"}


def idl_structs(path):
    """{"package/Type": [(name, type, kind, capacity)]} of one .idl file."""
    text = re.sub(r"//[^\n]*", "", path.read_text(encoding="utf-8"))
    package = re.search(r"module (\w+)", text).group(1)
    structs = {}
    for name, body in re.findall(r"@final struct (\w+)_ \{(.*?)\};", text, re.S):
        fields = []
        for type_text, field, size in re.findall(r"\s*([\w:<> ]+?) (\w+)(?:\[(\d+)\])?;", body):
            sequence = re.fullmatch(r"sequence<(.+)>", type_text)
            base = sequence.group(1) if sequence else type_text
            if base not in IDL_TYPES:
                parts = base.split("::")
                base = (parts[0] if len(parts) > 1 else package) + "/" + parts[-1].rstrip("_")
            kind = type_hashes.SEQUENCE if sequence else type_hashes.ARRAY if size else 0
            fields.append((field, IDL_TYPES.get(base, base), kind, int(size or 0)))
        structs[package + "/" + name] = fields
    return structs


def main():
    folder = ROOT / "idl" / "msg"
    failures = []
    for name, known in KNOWN.items():
        computed = type_hashes.type_hash(folder, name)
        if computed != known:
            failures.append("%s: computed %s, ROS 2 says %s" % (name, computed, known))
    structs = {}
    for path in sorted((ROOT / "idl" / "dds").glob("*.idl")):
        structs.update(idl_structs(path))
    messages = sorted(path.relative_to(folder).parts[0] + "/" + path.stem for path in folder.glob("**/*.msg"))
    if sorted(structs) != messages:
        failures.append("types differ: idl %s, msg %s" % (sorted(structs), messages))
    for name in messages:
        # ROS tells byte from uint8, IDL has octet for both.
        fields = [(f.name, "uint8" if f.base == "byte" else f.base, f.kind, f.capacity)
                  for f in type_hashes.read_msg(folder, name)[0]]
        if not fields or fields != structs.get(name):
            failures.append("%s: msg %s, idl %s" % (name, fields, structs.get(name)))
    built = set(re.findall(r'"msg/(\w+)\.msg"', (folder / "sextant_msgs" / "CMakeLists.txt").read_text(encoding="utf-8")))
    ours = {name.split("/")[1] for name in messages if name.startswith("sextant_msgs/")}
    if built != ours:
        failures.append("the ROS package builds %s, there are %s" % (sorted(built), sorted(ours)))
    for failure in failures:
        print("FAILED:", failure)
    print("%d types, %d known hashes, %d failures" % (len(messages), len(KNOWN), len(failures)))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
