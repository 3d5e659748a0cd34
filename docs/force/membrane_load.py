#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Where a fluid-filled membrane carries the tangential load while it is dragged.

docs/force/membrane_load.py SCENE [PICTURE] prints the table of docs/slip/stick_ratio.md, and draws it. SCENE is
the folder of a finite-element result with steps.csv, triangles.npy and, per step and node,
contact_flag (0 none, 1 stick, 2 slip), contact_ft (N), contact_area (mm^2) and nodes (mm).
"""
import csv
import gzip
import pathlib
import sys

import numpy as np


def load(scene, name):
    plain = scene / (name + ".npy")
    if plain.exists():
        return np.load(plain)
    with gzip.open(scene / (name + ".npy.gz")) as packed:
        return np.load(packed)


def traction_kpa(force, area, where):
    """Net tangential force over area of the chosen nodes."""
    return 1000 * np.linalg.norm(force[where].sum(0)) / area[where].sum() if where.any() else np.nan


def rows_of(scene):
    steps = list(csv.DictReader(open(scene / "steps.csv")))
    flag, force, area, nodes, triangles = (
        load(scene, n) for n in ("contact_flag", "contact_ft", "contact_area", "nodes", "triangles"))
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    sides = np.concatenate([sides, sides[:, ::-1]])
    first = [s["phase"] for s in steps].index("drag") - 1
    for k in range(first, len(steps)):
        if steps[k]["phase"] not in ("press", "drag"):
            break
        stick = flag[k] == 1
        border = np.zeros(len(stick), bool)
        border[sides[flag[k][sides[:, 1]] != 1, 0]] = True
        moved = nodes[k][stick] - nodes[first][stick]
        yield (float(np.hypot(*moved.mean(0)[:2])) if stick.any() else np.nan,
               float(np.hypot(float(steps[k]["Fx"]), float(steps[k]["Fy"]))),
               traction_kpa(force[k], area[k], stick & ~border),
               traction_kpa(force[k], area[k], stick & border),
               traction_kpa(force[k], area[k], flag[k] == 2),
               float(steps[k]["stick_ratio"]))


def draw(rows, picture):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    rows = np.array([r for r in rows if np.isfinite(r[2])])  # as long as there is an inside
    figure, left = pyplot.subplots(figsize=(7, 4))
    for column, name, style in ((4, "slipping", "s-"), (3, "sticking, beside slipping ones", "^-"),
                                (2, "sticking, all others", "o-")):
        left.plot(rows[:, 0], rows[:, column], style, label=name)
    left.set_xlabel("displacement of what sticks, mm")
    left.set_ylabel("tangential load per area, kPa")
    left.set_title("A fluid-filled pad is dragged: load of its segments")
    left.set_ylim(bottom=0)
    right = left.twinx()
    right.plot(rows[:, 0], rows[:, 1], "k--", label="tangential force (right)")
    right.set_ylabel("tangential force, N")
    right.set_ylim(bottom=0)
    lines = left.get_lines() + right.get_lines()
    left.legend(lines, [line.get_label() for line in lines], loc="upper center", ncol=2,
                bbox_to_anchor=(0.5, -0.16), frameon=False)
    figure.savefig(picture, dpi=110, bbox_inches="tight")


def main():
    rows = list(rows_of(pathlib.Path(sys.argv[1])))
    print("moved mm   force N   stick kPa   at border kPa   slip kPa   stick ratio")
    for row in rows:
        print("{:8.2f} {:9.2f} {:11.2f} {:15.2f} {:10.2f} {:13.2f}".format(*row))
    if len(sys.argv) > 2:
        draw(rows, sys.argv[2])


if __name__ == "__main__":
    main()
