#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What is proven, as a user sees it: proofs that are written, checked and refused; one search over ranks that are
killed and stopped, also behind the daemon; parts of the image and of the workspace."""
import ctypes
import ctypes.util
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

BIN, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
SEXTANT, RANKS = BIN / "sextant", BIN / "sextant-mpi"
SAMPLE = SOURCE / "data/sample"
# A coarse model of the views that the sample has: quick to learn, good enough to find the box.
PARAMETERS = """min_pitch_deg: 40
max_pitch_deg: 42
max_roll_deg: 0
angle_tolerance_deg: 3
images_per_bin: 20
scenes_per_bin: 12
grid: 40
"""
failures = []


def check(condition, what):
    if not condition:
        failures.append(what)
        print("FAILED:", what)


def run(*command, expect=0):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=800, cwd=SOURCE,
                          env={**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"})
    check(done.returncode == expect, f"exit {done.returncode}, expected {expect}: {' '.join(map(str, command))}\n"
          f"{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done


def answers(done):
    """The JSON lines without what may differ between two runs."""
    lines = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    for line in lines:
        line.pop("seconds")
        line.pop("nodes")
    return lines


def checksum(text):
    library = ctypes.CDLL(ctypes.util.find_library("xxhash") or "libxxhash.so.0")
    library.XXH3_64bits.restype = ctypes.c_uint64
    library.XXH3_64bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]
    return "%016x" % library.XXH3_64bits(text, len(text))


def sealed(proof):
    """The text of a proof with the checksum that fits it."""
    proof.pop("checksum", None)
    body = json.dumps(proof, separators=(",", ":"), ensure_ascii=False).encode()
    return json.dumps({**proof, "checksum": checksum(body)}, separators=(",", ":"), ensure_ascii=False)


def refused(done, words):
    check(done.stderr.count("\n") == 1 and words in done.stderr, f"one clear line about {words!r}: {done.stderr}")


def proofs(folder, model):
    proof = folder / "box.proof"
    options = ["--dataset", SAMPLE, "--image", 3, "--angle-tolerance-deg", 4]
    run(SEXTANT, "detect", model, *options, "--proof", proof)
    done = run(SEXTANT, "verify", proof, "--json")
    verdict = json.loads(done.stdout)
    check(verdict["holds"] and verdict["status"] == "optimal" and verdict["boxes"] > 1000, f"it holds: {verdict}")
    text = proof.read_text()
    whole = json.loads(text)
    check(sealed(json.loads(text)) == text.rstrip("\n"), "a proof is sealed as this test seals it")
    # Absence and an interrupted search are claims, too.
    other = folder / "other.proof"
    run(SEXTANT, "detect", model, *options, "--threshold", 100000, "--proof", other)
    check("absent with 0 detections: holds" in run(SEXTANT, "verify", other).stdout, "absence holds")
    run(SEXTANT, "detect", model, *options, "--deadline-ms", 0.01, "--proof", other)
    check("bounded" in run(SEXTANT, "verify", other).stdout, "a bounded answer holds")

    damaged = folder / "damaged.proof"
    damaged.write_text(text.replace('"status":"optimal"', '"status":"Optimal"'))
    refused(run(SEXTANT, "verify", damaged, expect=3), "was changed")
    damaged.write_text(text[:-20])
    refused(run(SEXTANT, "verify", damaged, expect=3), "is no JSON")
    refused(run(SEXTANT, "verify", model, expect=3), "is no JSON")
    refused(run(SEXTANT, "verify", folder / "none.proof", expect=3), "none.proof")

    def changed(change, expect):
        proof_now = json.loads(text)
        change(proof_now["frames"][0]["objects"][0])
        damaged.write_text(sealed(proof_now))
        return run(SEXTANT, "verify", damaged, expect=expect)

    # False claims, with a checksum that fits: another score, a worse pose, nothing there.
    def other_score(o):
        o["detections"][0]["score"] += 0.5
        o["upper_bound"] += 0.5

    def other_pose(o):
        o["detections"][0]["at"][5] += 1

    def nothing(o):
        o["detections"], o["status"], o["upper_bound"] = [], "absent", o["threshold"]

    def fewer_boxes(o):
        o["boxes"] = o["boxes"][:-1]

    check("FALSE" in changed(other_score, 5).stdout, "another score is false")
    changed(other_pose, 5)
    check("not established" in changed(nothing, 5).stdout, "absence is false")
    refused(changed(fewer_boxes, 3), "do not cover")

    # Another model, other frames.
    wrong = folder / "wrong.sxm"
    wrong.write_bytes(model.read_bytes() + b" ")
    refused(run(SEXTANT, "verify", proof, "--models", wrong, expect=3), "is not the model")
    copy = folder / "sample"
    shutil.copytree(SAMPLE, copy)
    check("holds" in run(SEXTANT, "verify", proof, "--dataset", copy).stdout, "a copy of the data set is as good")
    shutil.copy(next(copy.glob("test/*/depth/000002.png")), next(copy.glob("test/*/depth/000003.png")))
    refused(run(SEXTANT, "verify", proof, "--dataset", copy, expect=3), "is not the frame")
    check(whole["source"]["dataset"] == str(SAMPLE), "the proof says where the frames were")


def regions(model):
    options = [model, "--dataset", SAMPLE, "--image", 3, "--angle-tolerance-deg", 4, "--no-refine", "--json"]
    whole = answers(run(SEXTANT, "detect", *options))[0]
    box = whole["detections"][0]["bbox"]
    around = " ".join(str(int(v)) for v in box)
    check(answers(run(SEXTANT, "detect", *options, "--region", around))[0]["detections"] == whole["detections"],
          "the same pose where the region holds it")
    away = answers(run(SEXTANT, "detect", *options, "--region", "0 0 30 30"))[0]
    check(not away["detections"] or away["detections"][0]["log_score"] < whole["detections"][0]["log_score"],
          "nothing better in a corner")
    everywhere = answers(run(SEXTANT, "detect", *options, "--workspace", "-9 9 -9 9 -9 9"))[0]
    check(everywhere["detections"] == whole["detections"], "a large workspace changes nothing")
    nowhere = answers(run(SEXTANT, "detect", *options, "--workspace", "-9 9 -9 9 5 9"))[0]
    check(nowhere["objects"][0]["status"] == "absent", "nothing floats five metres above the table")
    run(SEXTANT, "detect", *options, "--region", "1 2 3", expect=2)
    run(SEXTANT, "detect", *options, "--region", "5000 0 10 10", expect=3)
    run(SEXTANT, "detect", *options, "--table", "none", "--workspace", "0 1 0 1 0 1", expect=3)


def ranks(model):
    if not shutil.which("mpirun") or not RANKS.exists():
        print("no mpirun or no sextant-mpi: the MPI part is skipped")
        return
    options = ["detect", model, "--dataset", SAMPLE, "--angle-tolerance-deg", 4, "--json", "--max-detections", 2,
               "--no-warm-start"]
    alone = answers(run(SEXTANT, *options))
    mpirun = ["mpirun", "--oversubscribe", "--enable-recovery"]
    for count in range(1, 7):
        check(answers(run(*mpirun, "-n", count, RANKS, *options)) == alone, f"{count} ranks change the answer")
    # Where the best place is doubtful, all ranks look for the next best one.
    doubtful = ["detect", model, "--dataset", SAMPLE, "--image", 0, "--angle-tolerance-deg", 4, "--region", "320 0 320 480",
                "--false-positive-rate", 1, "--threads", 1, "--json"]
    further = run(SEXTANT, *doubtful)
    nodes = [json.loads(done.stdout.splitlines()[0])["nodes"] for done in (run(SEXTANT, *doubtful, "--candidates", 1), further)]
    check(nodes[0] < nodes[1], f"a further place was looked at: {nodes}")
    for count in (2, 3):
        check(answers(run(*mpirun, "-n", count, RANKS, *doubtful)) == answers(further), f"{count} ranks look further differently")
    one = [*options, "--image", 1]
    truth = answers(run(SEXTANT, *one))
    for fault in ("1:64:9", "2:640:9"):  # SIGKILL
        done = run(*mpirun, "-n", 3, RANKS, *one, "--inject-fault", fault)
        check(answers(done) == truth, f"a killed rank ({fault}) changes the answer")
        check("died" in done.stderr, f"a killed rank is noticed: {done.stderr[-500:]}")
    # SIGSTOP: noticed by its silence. All the time in the world for the others on a busy machine.
    done = run(*mpirun, "-n", 3, RANKS, *one, "--inject-fault", "2:64:19", "--lost-after-s", 20)
    check(answers(done) == truth, "a stopped rank changes the answer")
    check("rank 2 is silent" in done.stderr, f"a stopped rank is noticed: {done.stderr[-500:]}")
    # All others dead: the coordinator goes on alone, also with the frames to come.
    done = run(*mpirun, "-n", 2, RANKS, *options, "--inject-fault", "1:64:9")
    check(answers(done) == alone, "alone after the death of all others")
    bounded = answers(run(*mpirun, "-n", 3, RANKS, *one, "--deadline-ms", 0.01))[0]
    check(bounded["objects"][0]["status"] == "bounded", "out of time it is bounded")
    best = truth[0]["detections"][0]["log_score"]
    found = bounded["detections"][0]["log_score"] if bounded["detections"] else -1e9
    check(max(found, bounded["objects"][0]["upper_bound"]) >= best, "the bound holds")
    run("mpirun", "--oversubscribe", "-n", 2, RANKS, "detect", model, "--dataset", SAMPLE, "--proof", "x", expect=2)


def poses_over_dds(config, command, env, domain, want, during=None):
    """Runs a daemon until so many frames have arrived; what it said of each image, and its log."""
    echo = subprocess.Popen([SEXTANT, "echo", "--domain", str(domain), "--count", str(want), "--timeout-s", "120", "--json",
                             "--require"], stdout=subprocess.PIPE, text=True, env=env)
    log = config.with_suffix(".log")
    with log.open("w") as out:
        daemon = subprocess.Popen([str(c) for c in command], stderr=out, env=env)
    try:
        if during:
            during(daemon, log)
        text = echo.communicate(timeout=150)[0]
        check(echo.returncode == 0, f"{command[0]}: {want} frames arrive; the log ends: {log.read_text()[-1500:]}")
    finally:
        daemon.terminate()
        check(daemon.wait(timeout=20) is not None, f"{command[0]} ends")
    frames = {}
    for line in text.splitlines():
        message = json.loads(line)
        answer = message["estimates"], message["objects"]
        image = message["frame_number"] % 4  # of the sample's four, which are played in a loop
        check(frames.setdefault(image, answer) == answer, f"one image, two answers: {frames[image]} and {answer}")
    return frames, log.read_text()


def children(pid):
    return [int(p) for p in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def serve(folder, model):
    """The daemon over ranks publishes what the daemon alone does; also when a rank is killed, and after a reload."""
    if not shutil.which("mpirun") or not RANKS.exists():
        print("no mpirun or no sextant-mpi: the MPI part is skipped")
        return
    domain = 30 + os.getpid() % 150
    env = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
           "CYCLONEDDS_URI": f"file://{SOURCE}/config/cyclonedds.xml"}
    config = folder / "serve.yaml"
    config.write_text(f"""source: {{kind: playback, dataset: "{SAMPLE}", loop: true, rate_hz: 4}}
models: {{files: ["{model}"]}}
detect: {{angle_tolerance_deg: 4, threads: 1}}
publish: {{domain: {domain}}}
""")
    alone, _ = poses_over_dds(config, [BIN / "sextantd", "--config", config], env, domain, 8)
    check(any(poses for poses, _ in alone.values()), f"the daemon alone finds the box: {alone}")

    def same(other):
        """Where both saw an image, which on a busy machine may not be every one of the four."""
        both = set(alone) & set(other)
        return both and all(alone[image] == other[image] for image in both)

    mpirun = ["mpirun", "--oversubscribe", "--enable-recovery", "-n", 3, RANKS, "serve", "--config", config]
    together, log = poses_over_dds(config, mpirun, env, domain, 8)
    check(same(together), f"three ranks publish something else: {together} instead of {alone}")

    def kill_one(daemon, log):
        for _ in range(600):
            if "publishing on DDS domain" in log.read_text():
                break
            time.sleep(0.1)
        time.sleep(1)
        os.kill(max(children(daemon.pid)), signal.SIGKILL)

    survived, log = poses_over_dds(config, mpirun, env, domain, 16, kill_one)
    check(same(survived), f"a killed rank changes what is published: {survived}")
    check("died" in log, f"a killed rank is noticed: {log[-1500:]}")
    # Frames farther apart than the silence that a searching rank may keep: those that wait are not lost.
    config.write_text(config.read_text().replace("rate_hz: 4", "rate_hz: 0.15"))
    _, log = poses_over_dds(config, [*mpirun, "--lost-after-s", 5], env, domain, 2)
    check("silent" not in log and "died" not in log, f"ranks that wait for a frame are lost: {log[-1500:]}")
    done = run("mpirun", "--oversubscribe", "-n", 2, RANKS, "serve", "--config", folder / "none.yaml", expect=3)
    check("none.yaml" in done.stderr, "a missing configuration is named")
    run(RANKS, "serve", expect=2)
    check("good" in run(RANKS, "serve", "--config", config, "--check-config").stdout, "a configuration can be checked")


with tempfile.TemporaryDirectory() as name:
    box = Path(sys.argv[3]).resolve() if len(sys.argv) > 3 else Path(name) / "box.sxm"
    if not box.exists():
        (Path(name) / "learning.yaml").write_text(PARAMETERS)
        run(SEXTANT, "compile", SOURCE / "data/meshes/printed_box.obj", "--units", "mm", "--up", "z", "--object-id", 1,
            "--params", Path(name) / "learning.yaml", "-o", box)
    parts = sys.argv[4].split(",") if len(sys.argv) > 4 else ["proofs", "regions", "ranks", "serve"]
    if "proofs" in parts:
        proofs(Path(name), box)
    if "regions" in parts:
        regions(box)
    if "ranks" in parts:
        ranks(box)
    if "serve" in parts:
        serve(Path(name), box)
print(f"{'failed' if failures else 'passed'}: {len(failures)} failures")
sys.exit(1 if failures else 0)
