#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Google Benchmark JSON (files, or standard input) to Markdown tables of speed against error.

One table for each group of rows ("group/row"). A time is the least CPU time of all repetitions;
ratios are to the first row of the table and to its rows called "streaming", within one run.
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
    return ", ".join(f"{value:.2g} {key.rsplit('_', 1)[1]} ({key.split('_')[0]})" if "_error_" in key
                     else f"{100 * value:.4g} % {key.rsplit('_', 1)[1]}"
                     for key, value in errors.items())


def print_group(group, rows):
    against = [name for k, name in enumerate(rows) if k == 0 or name.startswith("streaming")]
    print(f"\n**{group}**\n")
    print("| | ms | ns/pixel | error |" + "".join(f" time of {name} over its own |" for name in against))
    print("|---|--:|--:|--:|" + "--:|" * len(against))
    for name, (seconds, pixels, errors) in rows.items():
        ratios = (rows[other][0] / seconds for other in against)
        print(f"| {name} | {seconds * 1e3:.3f} | {seconds / pixels * 1e9:.3f} | {error_text(errors)} |"
              + "".join(f" {ratio:.3g} |" for ratio in ratios))


def main():
    for path in sys.argv[1:] or ["/dev/stdin"]:
        with open(path, encoding="utf-8") as file:
            run = json.load(file)
        print(f"\n### {run['context']['executable'].rsplit('/', 1)[1]}")
        for group, rows in rows_of(run).items():
            print_group(group, rows)


if __name__ == "__main__":
    main()
