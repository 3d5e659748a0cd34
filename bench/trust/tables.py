#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""tables.py CSV ... [--errors | --by condition|scene] [--picture PNG]: what confident numbers are worth.

Reads lines of `trust` and of judge.py. For each quantity: how many numbers are confident and wrong,
confident and right, doubted and wrong, doubted and right; then whether standard deviations hold.
--by has one line for each condition or scene in place of one for all."""
import argparse
import csv
import statistics
import sys

QUANTITIES = ("depth", "contact", "rotation", "place", "stick ratio", "F_xy", "F_z", "M_xy", "M_z")


def read(files):
    rows = []
    for file in files:
        with open(file, newline="", encoding="utf-8") as lines:
            rows += list(csv.DictReader(lines))
    for row in rows:
        for key in ("error", "limit", "sd"):
            row[key] = float(row[key])
        row["sure"] = row["confident"] == "1"
        known = row["sd"] == row["sd"] and row["sd"] > 0
        row["in_sd"] = row["error"] / row["sd"] if known else None
        row["wrong"] = row["error"] > row["limit"] or (known and row["in_sd"] > 5)
    return rows


def line(cells):
    print("| " + " | ".join(str(c) for c in cells) + " |")


def counts(rows):
    """Confident and wrong, confident and right, doubted and wrong, doubted and right."""
    return [sum(1 for r in rows if r["sure"] == sure and r["wrong"] == wrong)
            for sure, wrong in ((True, True), (True, False), (False, True), (False, False))]


def print_counts(rows, by):
    names = list(dict.fromkeys(r[by] for r in rows)) if by else [""]
    for quantity in QUANTITIES:
        for name in names:
            of = [r for r in rows if r["quantity"] == quantity and (not by or r[by] == name)]
            if not of:
                continue
            n = counts(of)
            per_mille = 1000 * n[0] / max(1, n[0] + n[1])
            sure = 100 * n[1] / max(1, n[1] + n[3])
            line([quantity] + ([name] if by else []) + n + ["%.1f" % per_mille, "%.0f" % sure])


def print_errors(rows):
    """Mean and worst error of each condition, in the units of trust and judge.py; in brackets how
    many of the numbers beyond the limit are confident."""
    present = [q for q in QUANTITIES if any(r["quantity"] == q for r in rows)]
    line(["condition"] + present)
    line(["---"] + ["--:"] * len(present))
    for name in dict.fromkeys(r["condition"] for r in rows):
        cells = [name]
        for quantity in present:
            of = [r for r in rows if r["quantity"] == quantity and r["condition"] == name]
            if of:
                errors = [r["error"] for r in of]
                sure = sum(1 for r in of if r["sure"] and r["error"] > r["limit"])
                cells.append("%.2g / %.2g%s" % (statistics.fmean(errors), max(errors),
                                                " (%d)" % sure if sure else ""))
            else:
                cells.append("-")
        line(cells)


def print_sd(rows):
    """Shares of confident numbers within two and beyond five of their standard deviations. Of an
    error with several parts the length is compared, which a normal error exceeds more often."""
    line(["quantity", "numbers", "within 2 sd, %", "beyond 5 sd, %", "median error / median sd"])
    line(["---", "--:", "--:", "--:", "--:"])
    for quantity in QUANTITIES + ("area",):
        of = [r for r in rows if r["quantity"] == quantity and r["sure"] and r["in_sd"] is not None]
        if of:
            ratio = (statistics.median(r["error"] for r in of) /
                     statistics.median(r["sd"] for r in of))
            line([quantity, len(of),
                  "%.1f" % (100 * sum(r["in_sd"] <= 2 for r in of) / len(of)),
                  "%.2f" % (100 * sum(r["in_sd"] > 5 for r in of) / len(of)), "%.2f" % ratio])


def draw(rows, file):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(7, 3.2), layout="constrained")
    present = [q for q in QUANTITIES if any(r["quantity"] == q for r in rows)]
    left = [0.0] * len(present)
    for k, (label, colour) in enumerate((("confident, wrong", "#c0392b"),
                                         ("doubted, wrong", "#e8b4a0"),
                                         ("doubted, right", "#c9d6df"),
                                         ("confident, right", "#2e6f95"))):
        order = (0, 2, 3, 1)[k]
        shares = []
        for q in present:
            n = counts([r for r in rows if r["quantity"] == q])
            shares.append(100 * n[order] / sum(n))
        axes.barh(present, shares, left=left, color=colour, label=label)
        left = [a + b for a, b in zip(left, shares)]
    axes.invert_yaxis()
    axes.set_xlabel("% of all numbers")
    axes.set_xlim(0, 100)
    axes.legend(ncols=4, loc="upper center", bbox_to_anchor=(0.45, 1.16), frameon=False, fontsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    figure.savefig(file, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("csv", nargs="+")
    parser.add_argument("--by", choices=("condition", "scene"))
    parser.add_argument("--errors", action="store_true", help="mean and worst by condition")
    parser.add_argument("--picture")
    options = parser.parse_args()
    rows = read(options.csv)
    if options.errors:
        print_errors(rows)
        return 0
    head = ["quantity"] + ([options.by] if options.by else [])
    line(head + ["confident, wrong", "confident, right", "doubted, wrong", "doubted, right",
                 "of 1,000 confident, wrong", "of 100 right, confident"])
    line(["---"] * len(head) + ["--:"] * 6)
    print_counts(rows, options.by)
    print()
    print_sd(rows)
    if options.picture:
        draw(rows, options.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
