#!/usr/bin/env python3
"""Compares the sun-hours engine with Embree: the same triangles, points and suns, on this machine, in one run.

    python3 -m venv /tmp/embree && /tmp/embree/bin/pip install numpy embreex==4.4.0.post1
    /tmp/embree/bin/python bench/embree.py [BOXES...]

For each number of boxes (500 and 15,000 unless given) it runs the example `city_hours` with one thread and with two, then Embree (through
embreex, its fastest call from Python: whether a ray is blocked, in batches of one sun) with one thread and two, in turns, five times, and
prints medians and ratios. Then every verdict is compared; where the two differ, the distance in metres from the receiver to the nearest
edge of a shadow is bounded by casting rays around it, in double precision.
"""

import json
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

ROUNDS = 5
RECEIVERS, SUNS = 250_000, 145
ENGINE = ["cargo", "run", "--quiet", "--release", "-p", "umbrae-study", "--example", "city_hours", "--"]


def engine(boxes, threads, folder=None):
    line = [*ENGINE, str(boxes), str(RECEIVERS), str(SUNS), str(threads), *([str(folder)] if folder else [])]
    return json.loads(subprocess.run(line, check=True, capture_output=True, text=True).stdout)


def embree(scene, origins, suns, threads):
    """Seconds, and for each receiver and sun whether it is lit."""
    lit = np.empty((len(suns), len(origins)), dtype=bool)
    parts = np.array_split(np.arange(len(origins)), threads)

    def work(part):
        mine = np.ascontiguousarray(origins[part])
        for i, sun in enumerate(suns):
            directions = np.broadcast_to(sun, mine.shape).astype(np.float32)
            lit[i, part] = scene.run(mine, directions, query="OCCLUDED") == -1

    start = time.perf_counter()
    workers = [threading.Thread(target=work, args=(part,)) for part in parts]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    return time.perf_counter() - start, lit.T


def is_blocked(triangles, origin, direction):
    """In double precision, against all triangles (T. Moeller and B. Trumbore 1997)."""
    a, ab, ac = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    p = np.cross(direction, ac)
    determinant = np.einsum("ij,ij->i", ab, p)
    with np.errstate(divide="ignore", invalid="ignore"):
        t0 = origin - a
        u = np.einsum("ij,ij->i", t0, p) / determinant
        q = np.cross(t0, ab)
        v = q @ direction / determinant
        t = np.einsum("ij,ij->i", ac, q) / determinant
        return bool(np.any((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)))


def distance_to_edge(triangles, origin, direction):
    """The least of a few radii at which a point around the receiver has another verdict."""
    across = np.cross(direction, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    up = np.cross(across, direction)
    here = is_blocked(triangles, origin, direction)
    for radius in (1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2):
        for angle in np.arange(16) * np.pi / 8:
            moved = origin + radius * (np.cos(angle) * across + np.sin(angle) * up)
            if is_blocked(triangles, moved, direction) != here:
                return radius
    return float("inf")


def compare(boxes):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        about = engine(boxes, 1, folder)
        triangles = np.fromfile(folder / "triangles.f32", "<f4").reshape(-1, 3, 3)
        receivers = np.fromfile(folder / "receivers.f64", "<f8").reshape(-1, 3)
        suns = np.fromfile(folder / "suns.f64", "<f8").reshape(-1, 3)
        ours = np.fromfile(folder / "lit.u8", np.uint8).reshape(len(receivers), len(suns)).astype(bool)
    scene = rtcore_scene.EmbreeScene()
    # It must not be let go while the scene is asked.
    mesh = TriangleMesh(scene, triangles)
    origins = receivers.astype(np.float32)
    print(f"{about['triangles']:,} triangles, {len(receivers):,} receivers, {len(suns)} suns")
    embree(scene, origins[:1000], suns[:1], 1)  # builds its tree
    tests = len(receivers) * len(suns) / 1e6
    for threads in (1, 2):
        times = {"umbrae": [], "embree": []}
        for _ in range(ROUNDS):
            times["umbrae"].append(engine(boxes, threads)["engine_s"])
            seconds, theirs = embree(scene, origins, suns, threads)
            times["embree"].append(seconds)
        ours_s, theirs_s = (statistics.median(times[who]) for who in ("umbrae", "embree"))
        ratios = [b / a for a, b in zip(times["umbrae"], times["embree"])]
        print(
            f"  {threads} thread(s): umbrae {ours_s:.3f} s ({tests / ours_s:.1f} M tests/s), embree {theirs_s:.3f} s "
            f"({tests / theirs_s:.1f} M/s), ratio {statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})"
        )
    differing = np.argwhere(ours != theirs)
    solid = triangles.astype(np.float64)
    distances = [distance_to_edge(solid, receivers[r], suns[s]) for r, s in differing]
    right = sum(is_blocked(solid, receivers[r], suns[s]) != ours[r, s] for r, s in differing)
    worst = max(distances, default=0.0)
    print(
        f"  verdicts that differ: {len(differing)} of {ours.size:,} ({1e5 * len(differing) / ours.size:.4f} in 100,000); "
        f"farthest from an edge: {worst:g} m or less; in double precision umbrae is right in {right}"
    )
    del mesh


for count in [int(arg) for arg in sys.argv[1:]] or [500, 15_000]:
    compare(count)
