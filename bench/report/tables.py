#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Markdown tables of speed against error: tables.py O2.json NATIVE.json prints those of a program."""
import sys

from runs import FLAGS, main_quantity, read


def number(x, digits=2):
    """Formats as 0.0123, 12.3, 1.2e-09."""
    if x == 0:
        return "0"
    if 1e-3 <= abs(x) < 1e5:
        text = f"{x:.{digits}g}"
        return f"{float(text):.0f}" if "e" in text else text
    return f"{x:.{digits}g}"


def size(count):
    for unit in ("B", "kB", "MB"):
        if count < 1000 or unit == "MB":
            return f"{count:.3g} {unit}"
        count /= 1000


def label(text):
    """Escapes `text` for Markdown, which would read <...> as a tag."""
    return text.replace("<", "&lt;").replace("|", "\\|")


def time_unit(rows):
    """The largest unit in which the fastest method takes at least 1."""
    least = min(row.median(flags) for row in rows for flags in row.seconds)
    return next((u, s) for u, s in (("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9))
                if least >= s or u == "ns")


def time_cell(row, flags, unit_s):
    if flags not in row.seconds:
        return ""
    return f"{number(row.median(flags) / unit_s, 3)} +- {100 * row.spread(flags):.0f} %"


def error_cell(error, found):
    if error is None:
        return ""
    text = " / ".join(number(x) for x in (error.median, error.high, error.worst))
    return text if found is None else f"{text}, of {100 * found:.3g} %"


def print_group(group, rows, out):
    rows = list(rows.values())
    first = rows[0]
    unit, unit_s = time_unit(rows)
    ways = [row for row in rows if not row.is_yardstick]
    yardsticks = [row for row in rows if row.is_yardstick]
    quantity, error = main_quantity(rows)
    heading = f"error of {quantity}, {error.unit}" if error else "error"
    columns = ["", f"-O2, {unit}", f"native, {unit}"]
    columns += ["ns per item"] if any(r.pixels > 1.5 for r in ways) else []
    columns += ["times as fast", heading, "memory", "allocations"]
    columns += [f"over {label(y.name)}" for y in yardsticks]
    out.write(f"\n**{group}**\n\n| {' | '.join(columns)} |\n")
    out.write("|---|" + "--:|" * (len(columns) - 1) + "\n")
    last = list(FLAGS)[-1]
    for row in rows:
        cells = [f"**{label(row.name)}**" if row.is_published else label(row.name)]
        cells += [time_cell(row, flags, unit_s) for flags in FLAGS]
        if any(r.pixels > 1.5 for r in ways):
            cells.append(number(row.median(last) / row.pixels * 1e9, 3))
        cells.append(number(first.median(last) / row.median(last), 3))
        cells.append(error_cell(row.errors.get(quantity), row.found.get(quantity)))
        cells += [size(row.bytes), f"{row.allocations:.0f}"]
        cells += [number(row.median(last) / y.median(last), 3) for y in yardsticks]
        out.write(f"| {' | '.join(cells)} |\n")
    print_other_errors(rows, quantity, out)


def print_other_errors(rows, main, out):
    others = []
    for row in rows:
        others += [(q, e.unit) for q, e in row.errors.items() if q != main and (q, e.unit) not in others]
    if not others:
        return
    out.write("\n| error of | " + " | ".join(f"{q}, {unit}" for q, unit in others) + " |\n")
    out.write("|---|" + "--:|" * len(others) + "\n")
    for row in rows:
        if any(q in row.errors for q, _ in others):
            cells = [error_cell(row.errors.get(q), row.found.get(q)) for q, _ in others]
            out.write(f"| {label(row.name)} | {' | '.join(cells)} |\n")


def main():
    for group, rows in read(dict(zip(FLAGS, sys.argv[1:]))).items():
        print_group(group, rows, sys.stdout)


if __name__ == "__main__":
    main()
