#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How far more workers help one search: scripts/bench scaling runs it.

A discrete-event simulation of offline/mpi (coordinator, private queues, status, best poses, delegation by rate), fed with
the search trees of four frames (easy, cluttered, two without the object), node by node with their measured costs, and with
message costs. It is checked against real runs of `sextant-mpi detect` at 1 to 4 ranks on this machine, and then asked about
up to 1000 workers with a core and a 10 Gbit link each. --self-test checks the simulation on trees whose answer is known.
"""
import argparse
import heapq
import json
import math
import os
import random
import shutil
import statistics
import subprocess
import sys
from dataclasses import dataclass

from programs import BIN, ROOT, run

OUT = os.path.join(ROOT, "build/bench/scaling")
NODES_PER_LOOK, STATUS_S, IDLE_STATUS_S, REST_S = 32, 0.002, 0.05, 0.0001
LEAST_TO_SHARE, MOST_TO_MOVE = 16, 4096
MYSELF = 0


@dataclass
class Network:
    latency_s: float        # of a short message
    bytes_per_s: float      # of a frame or of nodes
    handle_s: float         # a rank's own time for a message, sent or received
    cores: int = 0          # that all ranks share; 0: one each
    node_bytes: int = 48
    frame_bytes: int = 640 * 480 * (3 + 4)


class Tree:
    """The search of one frame as it was on one thread."""

    def __init__(self, head, parents, bounds, tiles, costs, best_after):
        self.prepare_s, self.begin_s, self.threshold = head["prepare_s"], head["begin_s"], head["threshold"]
        self.best_at_begin = head["best_at_begin"]
        ceiling, self.ranges = head["ceiling"], 16
        self.per_score = (self.ranges - 1) / (ceiling - self.threshold)
        # The frontier's ranges (runtime/search/lanes/frontier.h).
        self.range = [int(min(max((ceiling - b) * self.per_score, 0), self.ranges - 1)) for b in bounds]
        self.bound, self.tile, self.cost = bounds, tiles, costs
        self.children = [[] for _ in bounds]
        self.roots = []
        for node, parent in enumerate(parents):
            (self.children[parent] if parent >= 0 else self.roots).append(node)
        expanded = [c for c in costs if c > 0]
        self.usual_cost = statistics.median(expanded) if expanded else 1e-6
        self.final = max([self.best_at_begin] + best_after)
        # What expanding a node taught: a better pose than any before.
        self.score, best = {}, self.best_at_begin
        for node in sorted((n for n in range(len(costs)) if costs[n] > 0), key=lambda n: (best_after[n], n)):
            if best_after[node] > best:
                best = self.score[node] = best_after[node]

    @staticmethod
    def read(path):
        with open(path, encoding="utf-8") as f:
            head = json.loads(f.readline())
            rows = [line.split(",") for line in f]
        return Tree(head, [int(r[0]) for r in rows], [float(r[1]) for r in rows], [int(r[2]) for r in rows],
                    [1e-6 * float(r[3]) for r in rows], [float(r[4]) for r in rows])

    def begin(self, ranks):
        """Seconds for a rank's share of the roots, and its probes."""
        known = max(c for c in map(int, self.begin_s) if c <= ranks)
        return self.begin_s[str(known)]

    def serial_s(self):
        return self.prepare_s + self.begin(1) + sum(self.cost)


class Rank:
    def __init__(self, index):
        self.index, self.queue, self.inbox = index, [], []
        self.best, self.told, self.last_report = -math.inf, -math.inf, -math.inf
        self.expanded, self.taken, self.busy = 0, 0, False
        self.next_look = math.inf
        self.start = 0.0
        # What the coordinator knows of it.
        self.status, self.sent, self.wanted_by = None, 0, None


class Simulation:
    """One frame's search by `ranks` ranks; `makespan` is from the frame's arrival at rank 0 to the proven answer."""

    def __init__(self, tree, ranks, network, seed=1):
        self.t, self.net, self.count = tree, network, ranks
        self.ranks = [Rank(i) for i in range(ranks)]
        self.events, self.serial, self.puts = [], 0, 0
        self.moved = self.messages = self.wasted = 0
        self.coordinator_busy = 0.0
        self.last_arrival = {}
        self.makespan = None
        lucky = random.Random(seed).randrange(ranks)
        for node in tree.roots:
            self.push(self.ranks[tree.tile[node] % ranks], node)
        transfer = network.handle_s + network.frame_bytes / network.bytes_per_s
        for r in self.ranks:
            arrives = r.index * transfer + (network.latency_s if r.index else (ranks - 1) * transfer)
            r.start = arrives + tree.prepare_s * self.slowdown(ranks) + tree.begin(ranks) * self.slowdown(ranks)
            r.best = tree.best_at_begin if r.index == lucky else tree.threshold
            r.told = tree.threshold if r.index else r.best
            self.at(r.start, r)

    def slowdown(self, busy):
        return max(1.0, busy / self.net.cores) if self.net.cores else 1.0

    def push(self, rank, node):
        """Best range first, in it the last put first."""
        self.puts -= 1
        heapq.heappush(rank.queue, (self.t.range[node], self.puts, node))

    def at(self, time, rank):
        """A rank looks at its messages and its queue at this time, or before."""
        if time >= rank.next_look:
            return
        rank.next_look = time
        self.serial += 1
        heapq.heappush(self.events, (time, self.serial, rank.index))

    def send(self, now, sender, to, message, size=0):
        """The sender's clock after sending. Messages between two ranks arrive in their order."""
        now += self.net.handle_s
        pair = sender.index, to.index
        arrives = max(now + self.net.latency_s + size / self.net.bytes_per_s, self.last_arrival.get(pair, 0))
        self.last_arrival[pair] = arrives
        heapq.heappush(to.inbox, (arrives, self.messages, message))
        self.messages += 1
        if not to.queue:
            self.at(max(arrives, to.start), to)
        return now

    def run(self):
        while self.makespan is None:
            time, _, index = heapq.heappop(self.events)
            rank = self.ranks[index]
            if time != rank.next_look:
                continue
            rank.next_look = math.inf
            end = self.coordinate(rank, time) if index == 0 else self.work(rank, time)
            # An idle rank rests, then looks for messages; without one it says after a while that it is idle.
            if rank.queue:
                self.at(end, rank)
            elif index == 0:
                self.at(end + REST_S, rank)
            else:
                self.at(max(end + REST_S, rank.inbox[0][0]) if rank.inbox else end + IDLE_STATUS_S, rank)
        return self

    def messages_of(self, rank, now):
        while rank.inbox and rank.inbox[0][0] <= now:
            now += self.net.handle_s
            yield now, heapq.heappop(rank.inbox)[2]

    def drop_useless(self, rank):
        while rank.queue and self.t.bound[rank.queue[0][2]] < rank.best:
            heapq.heappop(rank.queue)

    def expand(self, rank, now):
        """Up to 32 nodes, best first."""
        factor = self.slowdown(sum(r.busy for r in self.ranks)) if self.net.cores else 1.0
        for _ in range(NODES_PER_LOOK):
            self.drop_useless(rank)
            if not rank.queue:
                break
            node = heapq.heappop(rank.queue)[2]
            if self.t.cost[node] > 0:
                now += self.t.cost[node] * factor
            else:  # one thread never had to: it knew a better pose by then
                now += self.t.usual_cost * factor
                self.wasted += 1
            for child in self.t.children[node]:
                self.push(rank, child)
            rank.expanded += 1
            rank.best = max(rank.best, self.t.score.get(node, -math.inf))
        self.drop_useless(rank)
        return now

    def work(self, rank, now):
        heard = False
        for now, (kind, value) in self.messages_of(rank, now):
            heard = True
            if kind == "best":
                rank.best = max(rank.best, value)
                rank.told = max(rank.told, value)
            elif kind == "take":
                rank.taken += 1
                for node in value:
                    self.push(rank, node)
            elif kind == "give":
                self.drop_useless(rank)
                nodes = [heapq.heappop(rank.queue)[2] for _ in range(min(value, len(rank.queue)))]
                now = self.send(now, rank, self.ranks[0], ("nodes", (rank.index, nodes)), self.net.node_bytes * len(nodes))
        was_busy = bool(rank.queue)
        rank.busy = was_busy
        if was_busy:
            now = self.expand(rank, now)
            if rank.best > rank.told:
                rank.told = rank.best
                now = self.send(now, rank, self.ranks[0], ("best", rank.best))
        idle = not rank.queue
        if heard or (was_busy and idle) or now - rank.last_report > (IDLE_STATUS_S if idle else STATUS_S):
            rate = rank.expanded / max(now - rank.start, 1e-6)
            now = self.send(now, rank, self.ranks[0], ("status", (rank.index, len(rank.queue), rank.taken, rate)))
            rank.last_report = now
        rank.busy = not idle
        return now

    def is_idle(self, rank):
        return rank.status is not None and rank.status[0] == 0 and rank.status[1] == rank.sent

    def move(self, now, to, nodes):
        if not nodes:
            return now
        to.sent += 1
        self.moved += len(nodes)
        return self.send(now, self.ranks[0], to, ("take", nodes), self.net.node_bytes * len(nodes))

    def coordinate(self, me, now):
        begin = now
        for now, (kind, value) in self.messages_of(me, now):
            if kind == "best":
                me.best = max(me.best, value)
            elif kind == "status":
                self.ranks[value[0]].status = value[1:]
            elif kind == "nodes":
                donor = self.ranks[value[0]]
                to, donor.wanted_by, donor.status = donor.wanted_by, None, None
                if to == MYSELF:
                    for node in value[1]:
                        self.push(me, node)
                else:
                    now = self.move(now, self.ranks[to], value[1])
        worked = bool(me.queue)
        me.busy = worked
        if worked:
            now = self.expand(me, now)
        if me.best > me.told:
            me.told = me.best
            for r in self.ranks[1:]:
                now = self.send(now, me, r, ("best", me.best))
        for r in self.ranks[1:]:
            if self.is_idle(r):
                now = self.feed(r, now)
        if not me.queue:
            now = self.feed(me, now)
            if all(self.is_idle(r) and r.wanted_by is None for r in self.ranks[1:]):
                self.makespan = now
        self.coordinator_busy += now - begin
        return now

    def feed(self, hungry, now):
        if any(r.wanted_by == hungry.index for r in self.ranks[1:]):
            return now
        me = self.ranks[0]
        elapsed = max(now - me.start, 1e-6)
        mine = me.expanded / elapsed
        rate = mine if hungry is me else hungry.status[2]

        def share(waiting, donor_rate):
            part = rate / (rate + donor_rate) if rate + donor_rate > 0 else 0.5
            return min(int(min(0.9, max(0.1, part)) * waiting), MOST_TO_MOVE)

        donors = [r for r in self.ranks[1:] if r.status and r.wanted_by is None and r.status[0] >= LEAST_TO_SHARE]
        richest = max(donors, key=lambda r: r.status[0], default=None)
        if hungry is not me and len(me.queue) >= LEAST_TO_SHARE and (
                richest is None or len(me.queue) >= richest.status[0]):
            nodes = [heapq.heappop(me.queue)[2] for _ in range(share(len(me.queue), mine))]
            return self.move(now, hungry, nodes)
        if richest is None:
            return now
        richest.wanted_by = hungry.index
        return self.send(now, me, richest, ("give", share(richest.status[0], richest.status[2])))


def self_test():
    """Trees whose answer is known."""
    head = {"prepare_s": 0.01, "begin_s": {"1": 0.002}, "threshold": 0.0, "ceiling": 2.0, "best_at_begin": 0.0}
    local = Network(1e-6, 1e12, 1e-7)
    nodes = 64 * 1000
    flat = Tree(head, [-1] * nodes, [1.0] * nodes, list(range(nodes)), [1e-5] * nodes, [0.0] * nodes)
    serial = Simulation(flat, 1, local).run().makespan
    assert abs(serial - flat.serial_s()) < 1e-3 * serial, (serial, flat.serial_s())
    for ranks in (2, 8, 64):  # independent, evenly dealt nodes: all but the constant part is divided
        ideal = 0.012 + 1e-5 * nodes / ranks
        took = Simulation(flat, ranks, local).run().makespan
        assert ideal <= took < 1.1 * ideal + 0.003, (ranks, took, ideal)
    uneven = Tree(head, [-1] * nodes, [1.0] * nodes, [0] * nodes, [1e-5] * nodes, [0.0] * nodes)
    moved = Simulation(uneven, 8, local).run()  # all on one rank at first: delegation has to spread them
    assert moved.moved > 0.5 * nodes and moved.makespan < 2 * (0.012 + 1e-5 * nodes / 8), (moved.moved, moved.makespan)
    chain = Tree(head, [-1] + list(range(999)), [1.0] * 1000, [0] * 1000, [1e-4] * 1000, [0.0] * 1000)
    assert Simulation(chain, 16, local).run().makespan >= chain.serial_s() - 1e-9, "a chain cannot be divided"
    shared = Simulation(flat, 4, Network(1e-6, 1e12, 1e-7, cores=2)).run().makespan
    assert shared > 0.95 * (1e-5 * nodes / 2), "four ranks on two cores are two"
    better, cost = [0.0] * nodes, [0.0] * nodes
    better[-1], cost[-1] = 2.0, 1e-5  # the first that is taken, by the last rank, shows that all others are useless
    pruned = Tree(head, [-1] * nodes, [1.0] * nodes, list(range(nodes)), cost, better)
    assert Simulation(pruned, 8, local).run().wasted < 8 * 2 * NODES_PER_LOOK, "what is known is told"
    print("scaling: the simulation is right about six trees whose answer is known")


def repeated(dataset, image, times):
    """A data set of one image, several times: the first runs warm the buffers."""
    scene = os.path.join(dataset, "test", "000001")
    folder = os.path.join(OUT, f"image{image}")
    shutil.rmtree(folder, ignore_errors=True)
    into = os.path.join(folder, "test", "000001")
    os.makedirs(into)
    for name in ("scene_camera.json", "scene_gt.json", "scene_gt_info.json", "scene_table.json"):
        path = os.path.join(scene, name)
        if os.path.exists(path):
            with open(path, encoding="utf-8") as f:
                entry = json.load(f)[str(image)]
            with open(os.path.join(into, name), "w", encoding="utf-8") as f:
                json.dump({str(i): entry for i in range(times)}, f)
    for kind in ("rgb", "depth"):
        os.makedirs(os.path.join(into, kind))
        for i in range(times):
            os.symlink(os.path.join(scene, kind, f"{image:06}.png"), os.path.join(into, kind, f"{i:06}.png"))
    return folder


def measured(model, dataset, image, ranks, times=5):
    """Seconds from a frame in memory to the proven pose, at the best of several."""
    env = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    done = subprocess.run(["mpirun", "--oversubscribe", "-n", str(ranks), os.path.join(BIN, "sextant-mpi"), "detect", model,
                           "--dataset", repeated(dataset, image, times), "--no-refine", "--no-runner-up", "--no-warm-start",
                           "--angle-tolerance-deg", "12", "--json"], capture_output=True, text=True, env=env, check=True)
    lines = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    return min(sum(line["seconds"][k] for k in ("features", "tables", "search")) for line in lines[1:])


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench scaling", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("--workers", type=int, nargs="*", default=[1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1000])
    a = parser.parse_args()
    self_test()
    if a.self_test:
        return
    search = os.path.join(ROOT, "build/bench/search")
    model = os.path.join(search, "printed_box.sxm")
    if not os.path.exists(model):
        sys.exit("scaling: run scripts/bench search first: it makes the model and the images")
    os.makedirs(OUT, exist_ok=True)
    here = Network(latency_s=5e-6, bytes_per_s=3e9, handle_s=2e-6, cores=os.cpu_count())
    there = Network(latency_s=30e-6, bytes_per_s=1.1e9, handle_s=3e-6)
    frames = [("easy", "with200", 2), ("cluttered", "with200", 0), ("without the object", "without50", 0),
              ("without it, hard", "without50", 23)]
    for name, folder, image in frames:
        trace = os.path.join(OUT, f"{folder}-{image}.csv")
        dataset = os.path.join(search, folder)
        run([os.path.join(BIN, "sextant-search-trace"), model, dataset, "--image", image, "--out", trace])
        tree = Tree.read(trace)
        expanded = sum(c > 0 for c in tree.cost)
        print(f"\n{name}: image {image} of {folder}: {expanded} nodes divided, {1e3 * sum(tree.cost):.0f} ms, roots and first"
              f" descents {1e3 * tree.begin(1):.1f} ms (a 1024th of the roots {1e3 * tree.begin(1024):.1f} ms), frame to tables"
              f" {1e3 * tree.prepare_s:.1f} ms")
        print("  here        ranks   measured   simulated")
        for ranks in (1, 2, 3, 4):
            real = measured(model, dataset, image, ranks)
            simulated = Simulation(tree, ranks, here).run().makespan
            print(f"  {'':11} {ranks:5} {1e3 * real:8.1f} ms {1e3 * simulated:8.1f} ms  x {simulated / real:.2f}")
        print("  a core and a 10 Gbit link each")
        print("            workers     frame   speed-up   search alone   moved   useless nodes   coordinator busy")
        alone = tree.serial_s()
        for workers in a.workers:
            s = Simulation(tree, workers, there).run()
            # The same where every worker has the frame already (its own camera stream, or multicast).
            local = Simulation(tree, workers, Network(there.latency_s, 1e15, there.handle_s)).run()
            search_s = local.makespan - tree.prepare_s
            print(f"  {workers:17} {1e3 * s.makespan:7.1f} ms {alone / s.makespan:8.1f}"
                  f" {(alone - tree.prepare_s) / search_s:14.1f} {s.moved:7} {s.wasted:15} {100 * s.coordinator_busy / s.makespan:15.0f} %")


if __name__ == "__main__":
    main()
