#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""tables.py CSV ... [--errors] [--by condition|scene] [--picture PNG] [--page PAGE NAME]

What confident numbers are worth.

Reads lines of `trust` and of judge.py. For each quantity: how many numbers are confident and wrong,
confident and right, doubted and wrong, doubted and right; then whether standard deviations hold.
--by has one line for each condition or scene in place of one for all. --errors has mean and worst
errors by condition or scene. --page writes what is printed otherwise into PAGE, between
<!-- trust: NAME --> and the next <!-- end -->."""
import argparse
import contextlib
import csv
import io
import statistics
import sys

UNITS = {"depth": ", mm", "contact": ", 1 - IoU", "rotation": ", deg", "place": ", mm",
         "F_xy": ", %", "F_z": ", %", "M_xy": ", %", "M_z": ", %"}
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


def print_frames(rows):
    """Which scenes and how many of their frames; the conditions share them."""
    print("Scenes: " + "; ".join(
        "%s, up to %d frames" % (scene, max(
            len({r["frame"] for r in rows if r["scene"] == scene and r["condition"] == name})
            for name in {r["condition"] for r in rows}))
        for scene in dict.fromkeys(r["scene"] for r in rows)) + ".\n")


def print_errors(rows, by):
    """Mean and worst error of each condition or scene; in brackets how many of the wrong numbers
    are confident."""
    present = [q for q in QUANTITIES if any(r["quantity"] == q for r in rows)]
    line([by, "frames"] + [q + UNITS.get(q, "") for q in present])
    line(["---"] + ["--:"] * (len(present) + 1))
    for name in dict.fromkeys(r[by] for r in rows):
        cells = [name, len({(r["condition"], r["scene"], r["frame"]) for r in rows
                            if r[by] == name and r["quantity"] != "refused"}) or "refused"]
        for quantity in present:
            of = [r for r in rows if r["quantity"] == quantity and r[by] == name]
            if of:
                per = 100 if UNITS.get(quantity) == ", %" else 1
                errors = [per * r["error"] for r in of]
                sure = sum(1 for r in of if r["sure"] and r["wrong"])
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
    axes.set_title("Red is what harms: a wrong number with status ok", loc="left", fontsize=10, pad=24)
    axes.legend(ncols=4, loc="upper center", bbox_to_anchor=(0.45, 1.1), frameon=False, fontsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    figure.savefig(file, dpi=110)


def print_tables(rows, options):
    if options.errors:
        print_errors(rows, options.by or "condition")
        return
    print_frames(rows)
    head = ["quantity"] + ([options.by] if options.by else [])
    line(head + ["confident, wrong", "confident, right", "doubted, wrong", "doubted, right",
                 "of 1,000 confident, wrong", "of 100 right, confident"])
    line(["---"] * len(head) + ["--:"] * 6)
    print_counts(rows, options.by)
    print()
    print_sd(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("csv", nargs="+")
    parser.add_argument("--by", choices=("condition", "scene"))
    parser.add_argument("--errors", action="store_true", help="mean and worst, by condition or scene")
    parser.add_argument("--picture")
    parser.add_argument("--page", nargs=2, metavar=("PAGE", "NAME"))
    options = parser.parse_args()
    rows = read(options.csv)
    if options.picture:
        draw(rows, options.picture)
    if not options.page:
        print_tables(rows, options)
        return 0
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        print_tables(rows, options)
    page, name = options.page
    with open(page, encoding="utf-8") as file:
        before, begin, rest = file.read().partition("<!-- trust: %s -->\n" % name)
    _, end, after = rest.partition("<!-- end -->")
    if not end:
        sys.exit("%s has no <!-- trust: %s --> with an <!-- end -->" % (page, name))
    with open(page, "w", encoding="utf-8") as file:
        file.write(before + begin + "\n" + text.getvalue() + "\n" + end + after)
    return 0


if __name__ == "__main__":
    sys.exit(main())
