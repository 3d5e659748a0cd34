#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Draws the output of `calibrate ... --plots DIR`: one picture per calibration, fit and residuals."""
import csv
import os
import pathlib
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt


def draw(table):
    with open(table, newline="") as stream:
        rows = list(csv.reader(stream))
    x, measured, fitted = zip(*sorted(tuple(map(float, row)) for row in rows[1:]))
    x_name, y_name = rows[0][0], os.path.commonprefix(rows[0][1:3]).strip()
    labels = [name.removeprefix(y_name).strip() for name in rows[0][1:3]]
    figure, (above, below) = plt.subplots(
        2, 1, sharex=True, figsize=(7, 5), height_ratios=(3, 1), layout="constrained")
    above.plot(x, measured, ".", ms=5, alpha=0.6, label=labels[0])
    above.plot(x, fitted, "k_", ms=8, label=labels[1])
    above.set(ylabel=y_name, title=table.stem.replace("_", " "))
    above.legend(frameon=False)
    below.plot(x, [m - f for m, f in zip(measured, fitted)], ".", ms=4)
    below.axhline(0, color="k", lw=0.8)
    below.set(xlabel=x_name, ylabel="difference")
    figure.savefig(table.with_suffix(".png"), dpi=110)
    plt.close(figure)


if len(sys.argv) != 2:
    sys.exit("usage: plot.py DIR")
for table in sorted(pathlib.Path(sys.argv[1]).glob("*.csv")):
    draw(table)
