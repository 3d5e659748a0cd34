#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Google Benchmark JSON (files, or standard input) to Markdown tables of speed against error.

One table for each group of rows ("group/row"). A time is the least CPU time of all repetitions;
ratios are to the first row of the table and to its rows called "streaming", of the same run.
"""
import json
import sys


def rows_of(run):
    """{group: {row: (least seconds, counters)}}, in the order of the program whatever that of the run."""
    unit = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
    groups = {}
    for b in sorted(run["benchmarks"], key=lambda b: b["family_index"]):
        if b.get("run_type") == "aggregate":
            continue
        group, row = b["run_name"].split("/", 1)
        seconds = b["cpu_time"] * unit[b["time_unit"]]
        pixels = b["pixels/s"] * seconds
        best = groups.setdefault(group, {}).get(row)
        if best is None or seconds < best[0]:
            errors = {k: v for k, v in b.items() if "_error_" in k or k.startswith("share_")}
            groups[group][row] = (seconds, pixels, errors)
    return groups


def error_text(errors):
    """max_error_mm = 1e-5 reads "max 1e-05 mm", share_found = 0.9 reads "90 % found"."""
    parts = []
    for key, value in errors.items():
        kind, *_, last = key.split("_")
        parts.append(f"{100 * value:.4g} % {last}" if kind == "share" else f"{kind} {value:.2g} {last}")
    return ", ".join(parts)


def print_group(group, rows):
    first = next(iter(rows))
    streams = [name for name in rows if name.startswith("streaming")]
    print(f"\n**{group}**\n")
    print(f"| | ms | ns/pixel | error | faster than {first} |"
          + "".join(f" time over {name} |" for name in streams))
    print("|---|--:|--:|--:|--:|" + "--:|" * len(streams))
    for name, (seconds, pixels, errors) in rows.items():
        print(f"| {name} | {seconds * 1e3:.4g} | {seconds / pixels * 1e9:.4g} | {error_text(errors)}"
              f" | {rows[first][0] / seconds:.3g} |"
              + "".join(f" {seconds / rows[stream][0]:.3g} |" for stream in streams))


def main():
    for path in sys.argv[1:] or ["/dev/stdin"]:
        with open(path, encoding="utf-8") as file:
            run = json.load(file)
        print(f"\n### {run['context']['executable'].rsplit('/', 1)[1]}")
        for group, rows in rows_of(run).items():
            print_group(group, rows)


if __name__ == "__main__":
    main()
