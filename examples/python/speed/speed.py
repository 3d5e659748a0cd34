#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""speed.py FRAME [FRAMES]: compares the time of a frame from Python with that of the program FRAME, which
computes the same in C++. Both alternate, so that other load of the machine affects both alike; the
shortest time of each is used."""
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from PIL import Image

import fingerpad as fp

PRESS = Path(__file__).parents[2] / "data/press"


def picture(name):
    return np.array(Image.open(PRESS / name))


def main(frame, frames):
    pad, shape, image = picture("reference.png"), picture("reference_depth.tiff"), picture("frames/000005.png")
    rows, cols = shape.shape
    channels = [np.ascontiguousarray(a[..., c]) for a in (pad, image) for c in (0, 1)]
    camera = fp.Camera(center_x_px=(cols - 1) / 2, center_y_px=(rows - 1) / 2)
    fluid = fp.Absorption()
    estimate = fp.DepthEstimator(camera, fluid, fp.fit_reference(camera, fluid, *channels[:2], shape))
    region = fp.ContactRegion(camera, rows, cols, fp.ContactTest(free_apex_mm=13.03))
    arrays = np.zeros(shape.shape, np.float32), np.zeros(shape.shape, np.uint8), np.zeros(shape.shape, np.uint8)
    if hasattr(os, "sched_setaffinity"):  # both on one core, which the program inherits
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    with tempfile.NamedTemporaryFile() as file:
        for grid in (*channels[:2], shape.astype(np.float32), *channels[2:]):
            file.write(grid.tobytes())
        file.flush()
        cpp = subprocess.Popen([frame, str(rows), str(cols), file.name], text=True,
                               stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        # (new arrays, own arrays, C++ twice) x (depth, contact, both). The second call of a turn has a
        # warm cache, so the two Python variants alternate.
        times = np.empty((frames, 4, 3))
        for k in range(frames):
            for way in (k % 2, 1 - k % 2):
                start = time.perf_counter()
                depth, _, _ = estimate(*channels[2:], out=arrays[:2] if way else None)
                middle = time.perf_counter()
                region(depth, out=arrays[2] if way else None)
                end = time.perf_counter()
                times[k, way] = middle - start, end - middle, end - start
            print("\n", file=cpp.stdin, flush=True)
            for turn in (2, 3):
                times[k, turn] = [float(s) for s in cpp.stdout.readline().split()]
        cpp.communicate()
    for what, (new, ours, *cpp) in zip(("depth", "contact", "both"), 1e3 * times.min(0).T):
        cpp = min(cpp)
        print(f"{what:8} {cpp:6.3f} ms from C++; from Python {new:6.3f} ms ({100 * (new / cpp - 1):+.1f} %), "
              f"with out= {ours:6.3f} ms ({100 * (ours / cpp - 1):+.1f} %)")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1000)
