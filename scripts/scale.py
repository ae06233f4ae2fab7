#!/usr/bin/env python3
"""Costs of a sweep in shards, and what they say about a study of 10^4 tools, 10^3 parts, 10^6 triangles and 10^3 directions:
scripts/scale.py [SIZE]

Prints the tables of docs/scale.md. Needs the package touchoff[ray] and two cores. The part is a corrugated block of 12 SIZE^2 triangles, made here."""

import heapq
import os
import random
import statistics
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import ray
import touchoff
import touchoff.distributed
from touchoff import _touchoff

SHARDS, DIRECTIONS, TOOLS = 16, 50, ["D2Ball", "BallEr16"]
RULES = (DIRECTIONS, 0.05, 0.0, [], False)


def corrugated(size: int) -> touchoff.Part:
    """A block of 40 x 40 x 20 mm whose top goes up and down by 2 mm, each face of 2 size^2 triangles."""
    lines = np.linspace(-0.5, 0.5, size + 1)
    vertices, faces, known = [], [], {}
    for axis in range(3):
        for side in (-0.5, 0.5):
            for i in range(size):
                for j in range(size):
                    corners = []
                    for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        place = [0.0, 0.0, 0.0]
                        place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3] = side, lines[i + u], lines[j + v]
                        key = tuple(round(value, 9) for value in place)
                        if key not in known:
                            known[key] = len(vertices)
                            vertices.append(place)
                        corners.append(known[key])
                    a, b, c, d = corners if side > 0 else corners[::-1]
                    faces += [(a, b, c), (a, c, d)]
    body = np.array(vertices) * (40, 40, 20)
    top = body[:, 2] > 9.99
    body[top, 2] += 2 * (np.round(body[top, 0] / 4) % 2)
    return touchoff.Part(body, np.array(faces), unit="mm")


def study(part: touchoff.Part) -> _touchoff.Study:
    return _touchoff.Study(part._rust, [touchoff.Tool.library(name)._rust for name in TOOLS], *RULES)


def seconds(run) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


_own: list = []


def _begin(arrays) -> None:
    vertices, faces = arrays
    _own.append(study(touchoff.Part(vertices, faces, unit="mm")))


def _one(number: int) -> int:
    return len(_own[0].shard(number, SHARDS, 1))


def processes(part: touchoff.Part, count: int) -> float:
    """A plain loop over the shards, in processes that have the part already."""
    with ProcessPoolExecutor(count, initializer=_begin, initargs=((part.vertices, part.faces),)) as pool:
        list(pool.map(_one, [1] * count))
        return seconds(lambda: list(pool.map(_one, range(1, SHARDS + 1))))


def on_ray(part: touchoff.Part, cores: int) -> float:
    """The same shards as tasks of Ray, with the workers started before."""
    ray.init(num_cpus=cores, log_to_driver=False, logging_level="error")
    tools = [touchoff.Tool.library(name) for name in TOOLS]
    run = lambda folder: touchoff.distributed.sweep(  # noqa: E731
        {"part": part}, tools, folder=folder, shards=SHARDS, directions=DIRECTIONS, tolerance=0.05
    )
    with tempfile.TemporaryDirectory() as warm, tempfile.TemporaryDirectory() as folder:
        touchoff.distributed.sweep({"part": corrugated(4)}, tools, folder=warm, shards=2, directions=2, tolerance=0.05)
        took = seconds(lambda: run(folder))
    ray.shutdown()
    return took


def _nothing(number: int) -> bytes:
    return bytes(number)


def dispatch_time() -> float:
    """The time of the caller for a task of Ray that does nothing and returns a thousand bytes, of 64 that are open."""
    ray.init(num_cpus=2, log_to_driver=False, logging_level="error")
    task, count = ray.remote(num_cpus=1)(_nothing), 2000

    def run(tasks: int) -> None:
        open_tasks: list = []
        for _ in range(tasks):
            if len(open_tasks) == 64:
                ready, open_tasks = ray.wait(open_tasks, num_returns=1)
                ray.get(ready)
            open_tasks.append(task.remote(1000))
        ray.get(open_tasks)

    run(100)
    took = seconds(lambda: run(count)) / count
    ray.shutdown()
    return took


def simulated(cores: int, tasks: int, task_s: float, spread: float, dispatch_s: float) -> float:
    """The time of tasks on cores of which a driver starts one after the other: a queue by the time at which a core is free."""
    draw = random.Random(1)
    # Groups of tasks stand for more of them, so that the queue stays short.
    group = max(1, tasks // 200_000)
    free = [0.0] * min(cores, tasks // group)
    heapq.heapify(free)
    driver = last = 0.0
    for _ in range(tasks // group):
        driver += group * dispatch_s
        begin = max(driver, heapq.heappop(free))
        end = begin + group * task_s * max(0.1, draw.gauss(1.0, spread / group**0.5))
        last = max(last, end)
        heapq.heappush(free, end)
    return last


def main() -> None:
    size = int(sys.argv[1]) if len(sys.argv) > 1 else 40
    part = corrugated(size)
    swept = study(part)
    swept.shard(1, SHARDS, 1)
    postures = len(part.faces) * 2 * DIRECTIONS * len(TOOLS)
    print(f"{len(part.faces)} triangles, {2 * DIRECTIONS} directions, {len(TOOLS)} tools, {SHARDS} shards, {os.cpu_count()} cores")
    runs: dict[str, list[float]] = {}
    for _ in range(3):
        one_thread = [seconds(lambda k=k: swept.shard(k, SHARDS, 1)) for k in range(1, SHARDS + 1)]
        runs.setdefault("one process, one thread", []).append(sum(one_thread))
        runs.setdefault("one process, two threads", []).append(seconds(lambda: [swept.shard(k, SHARDS, 2) for k in range(1, SHARDS + 1)]))
        for count in (1, 2):
            runs.setdefault(f"a pool of {count}", []).append(processes(part, count))
            runs.setdefault(f"Ray with {count} core{'s' if count > 1 else ''}", []).append(on_ray(part, count))
    medians = {name: statistics.median(times) for name, times in runs.items()}
    alone = medians["one process, one thread"]
    print("\n| 16 shards | time | postures/s per core | efficiency |\n|---|--:|--:|--:|")
    for name, time_s in medians.items():
        cores = 2 if name.endswith(("two threads", "of 2", "2 cores")) else 1
        print(f"| {name} | {time_s:.2f} s | {postures / time_s / cores:,.0f} | {alone / time_s / cores:.2f} |")
    shards = [swept.shard(k, SHARDS, 2) for k in range(1, SHARDS + 1)]
    sent = part.vertices.nbytes + part.faces.nbytes
    back = sum(map(len, shards))
    with tempfile.TemporaryDirectory() as folder:
        files = [str(Path(folder) / f"{k}.parquet") for k in range(SHARDS)]
        for file, content in zip(files, shards, strict=True):
            _touchoff.write_shard(file, content)
        merging = statistics.median(
            seconds(lambda: _touchoff.merge_shards(files, str(Path(folder) / "all.parquet"))) for _ in range(5)
        )
    rows = len(part.faces) * len(TOOLS)
    print(f"\nbytes: {sent:,} to each machine, {back:,} back ({back / rows:.0f} per triangle and tool); merging {1e3 * merging:.0f} ms "
          f"({1e6 * merging / rows:.1f} µs per triangle and tool)")
    rate = postures / alone
    spread = statistics.stdev(one_thread) / statistics.mean(one_thread)
    dispatch = dispatch_time()
    tree = seconds(lambda: study(touchoff.Part(part.vertices, part.faces, unit="mm")))
    print(f"an empty task of Ray takes {1e3 * dispatch:.2f} ms of the caller; a worker prepares the part once in {1e3 * tree:.0f} ms; "
          f"shards differ by {100 * spread:.0f} % (standard deviation)")
    found = touchoff.sweep(part, [touchoff.Tool.library(name) for name in TOOLS], directions=DIRECTIONS, tolerance=0.05)
    slim, stout = found.reached[:, 0], found.reached[:, 1]
    corners = part.vertices[part.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    is_facing = normals @ found.directions.T > 0
    print(f"the slim tool does not reach {100 * (1 - slim.mean()):.0f} % of all triangles and directions, the stout one {100 * (1 - stout.mean()):.0f} %; "
          f"the stout one reaches {int((stout & ~slim).sum())} of those that the slim one does not; "
          f"{100 * is_facing.mean():.1f} % face the triangle, {100 * (is_facing & ~slim).mean():.1f} % without being reached by the slim one")
    # Half of the directions do not face a triangle, and the tree of 10^6 triangles is deeper; the rate is taken as it is.
    total = 1e4 * 1e3 * 1e6 * 1e3
    core_hours = total / rate / 3600
    print(f"\n10^16 postures: {core_hours:,.0f} core hours")
    print("\n| cores | task | tasks | time | busy | limit |\n|--:|--:|--:|--:|--:|---|")
    for cores, task_s in [(100, 600), (1_000, 600), (10_000, 600), (10_000, 10), (100_000, 600), (100_000, 60)]:
        tasks = int(total / rate / task_s)
        took = simulated(cores, tasks, task_s, spread, dispatch)
        busy = total / rate / took / cores
        limit = "cores" if busy > 0.95 else "one caller that starts all tasks, and the last tasks"
        print(f"| {cores:,} | {task_s} s | {tasks:,} | {took / 3600:,.1f} h | {100 * busy:.0f} % | {limit} |")
    table = total / 1e3 * back / rows
    print(f"\ntables: {table / 1e12:,.0f} TB (a set of 10^3 directions takes 125 bytes: {1e13 * 125 / 1e12:,.0f} TB of them); parts: "
          f"{1e3 * 1e6 * sent / len(part.faces) / 1e9:,.0f} GB")


if __name__ == "__main__":
    main()
