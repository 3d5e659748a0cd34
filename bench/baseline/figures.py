#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Errors and times of the benchmarks as CSV, and what became worse.

figures.py write FOLDER OUT    reads PROGRAM_{o2,native}.json in FOLDER, writes OUT/errors.csv and OUT/times.csv
figures.py compare OLD NEW     two folders with errors.csv and times.csv: each error whose median is
                               worse by more than a twentieth, each time by more than a tenth
figures.py asserted FOLDER OUT what the tests of accuracy measured: each FOLDER/NAME.xml that `-s -r xml` wrote,
                               into OUT/accuracy.csv
       --rename 'OLD=NEW' ...  rows or groups that have another name since, as regular expressions

Errors do not depend on the machine. Times do: compare only those of one run on one machine.
"""
import argparse
import csv
import json
import pathlib
import re
import sys
from xml.etree import ElementTree

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "report"))
from runs import FLAGS, read  # noqa: E402

ERRORS = ["program", "group", "row", "quantity", "unit", "median", "p99", "worst", "found"]
TIMES = ["program", "group", "row", "o2_us", "native_us", "bytes", "allocations"]


def write_chain(folder, errors, times):
    """The whole chain: its errors, those of the first flags, and the time of each stage and pass."""
    runs = {f: json.loads(p.read_text()) for f in FLAGS if (p := folder / f"chain_{f}.json").exists()}

    def chains_of(run):
        found = {name: (of["errors"], {**of["stages_ms"], "whole": of["whole_ms"],
                                       **{f"pass: {k}": v for k, v in run["passes_ms"].get(name, {}).items()}})
                 for name, of in run["chains"].items()}
        return found | {f"{of['policies']}, samples of {of['step']}": (of["errors"], {"whole": of["whole_ms"]})
                        for of in run["samples"]}
    chains = {f: chains_of(run) for f, run in runs.items()}
    for name, (of, rows) in next(iter(chains.values()), {}).items():
        for quantity, e in of.items():
            errors.writerow(["chain", name, "whole", quantity, e["unit"],
                             *(f"{e[k]:.6g}" for k in ("median", "99 %", "worst")),
                             "" if e["found"] == 1 else f"{e['found']:.6g}"])
        for row in rows:
            times.writerow(["chain", name, row,
                            *(f"{1e3 * chains[f][name][1][row]:.4g}" if f in chains else "" for f in FLAGS), "", ""])


def write(folder, out):
    programs = sorted({p.name.rsplit("_", 1)[0] for p in folder.glob("*_o2.json") if p.name != "chain_o2.json"})
    with open(out / "errors.csv", "w", newline="") as errors, open(out / "times.csv", "w", newline="") as times:
        errors, times = (csv.writer(f, lineterminator="\n") for f in (errors, times))
        errors.writerow(ERRORS)
        times.writerow(TIMES)
        write_chain(folder, errors, times)
        for program in programs:
            paths = {f: folder / f"{program}_{f}.json" for f in FLAGS}
            for group, rows in read({f: p for f, p in paths.items() if p.exists()}).items():
                for name, row in rows.items():
                    times.writerow([program, group, name]
                                   + [f"{1e6 * row.median(f):.4g}" if f in row.seconds else "" for f in FLAGS]
                                   + [f"{row.bytes:.0f}", f"{row.allocations:.0f}"])
                    for quantity, e in row.errors.items():
                        found = row.found.get(quantity)
                        errors.writerow([program, group, name, quantity, e.unit, f"{e.median:.6g}", f"{e.high:.6g}",
                                         f"{e.worst:.6g}", "" if found is None else f"{found:.6g}"])


def asserted(folder, out):
    squeeze = lambda text: " ".join((text or "").split())
    with open(out / "accuracy.csv", "w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["program", "test", "where", "asserted", "measured"])
        seen = set()
        for path in sorted(folder.glob("*.xml")):
            for case in ElementTree.parse(path).iter("TestCase"):
                for of in [case, *case.iter("Section")]:
                    where = []
                    for part in of:
                        if part.tag == "Info":
                            where.append(squeeze(part.text))
                        elif part.tag == "Expression":
                            row = (path.stem, case.get("name"), "; ".join(([of.get("name")] if of is not case else [])
                                                                          + where),
                                   squeeze(part.find("Original").text), squeeze(part.find("Expanded").text))
                            where = []
                            if row not in seen and row[3] != row[4]:
                                seen.add(row)
                                rows.writerow(row)


def rows_of(path, keys, renames):
    with open(path, newline="") as file:
        rows = {}
        for row in csv.DictReader(file):
            key = "|".join(row[k] for k in keys)
            for old, new in renames:
                key = re.sub(old, new, key)
            rows[key] = row
        return rows


def compare(old, new, renames):
    def worse(file, keys, columns, share):
        before, after = rows_of(old / file, keys, renames), rows_of(new / file, keys, [])
        both = [k for k in before if k in after]
        print(f"{file}: {len(both)} rows in both, {len(before) - len(both)} only before, "
              f"{len(after) - len(both)} only after")
        for key in both:
            for column in columns:
                a, b = before[key][column], after[key][column]
                if a and b and float(b) > (1 + share) * float(a):
                    print(f"  {key}: {column} {a} -> {b}")
    worse("errors.csv", ERRORS[:5], ["median"], 0.05)
    worse("times.csv", TIMES[:3], ["o2_us", "native_us"], 0.1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["write", "asserted", "compare"])
    parser.add_argument("first", type=pathlib.Path)
    parser.add_argument("second", type=pathlib.Path)
    parser.add_argument("--rename", nargs="*", default=[])
    args = parser.parse_args()
    if args.what == "write":
        write(args.first, args.second)
    elif args.what == "asserted":
        asserted(args.first, args.second)
    else:
        compare(args.first, args.second, [r.split("=", 1) for r in args.rename])


if __name__ == "__main__":
    main()
