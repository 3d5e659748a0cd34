#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Writes the report: pages.py BUILD DOCS COMPILER, from the results in BUILD.

Their tables stand between <!-- table: NAME --> and <!-- end --> in docs/results.md,
docs/speed_and_error.md, docs/papers.md, docs/peers.md and docs/hard_cases.md; all else on these pages is written by
hand. The pictures are beside them.
"""
import io
import json
import pathlib
import re
import subprocess
import sys

import plots
from runs import FLAGS, read
from tables import number, print_group, size

# {program: heading}
METHODS = {
    "depth": "Depth: inversion",
    "frame": "Depth: the whole step",
    "neighbour_light": "Neighbour light",
    "optics": "Optics",
    "curvature": "Curvature",
    "contact_region": "Contact region",
    "object_surface": "Object surface",
    "object_motion": "Motion of the object",
    "stick_ratio": "Stick ratio",
    "spatial_stick_ratio": "Stick ratio in space",
    "gel_slide": "Gel slide",
    "grip_control": "Grip control",
    "wrench": "Six axes from dots in the picture",
    "traction": "Traction",
    "normal_force": "Normal force",
    "contact_shift": "Shift of the contact",
    "shear": "Tangential force and moment",
    "taxel_features": "Taxel features",
    "preslip": "Pre-slip",
    "dot_finder": "Printed dots",
    "foam_contact": "Foam contact",
    "calibrations": "Calibrations",
}
# The published method against the default: (label, program, group, published row, our row).
COMPARED = [
    ("depth of a pixel, rendered", "depth", "full pad, depths up to 14 mm", "published bisection, double",
     "exponential-free float <3, 6>"),
    ("depth of a noisy frame, rendered", "frame", "round pad", "published: BoxMean + Bisection in double",
     "BiasFreeMean + ExponentialFree<>"),
    ("curvature of caps", "curvature", "round pad, radius 10 px", "published circle, double",
     "clamped mean, float, through a camera, the default"),
    ("contact's area", "contact_region", "350 mm^2", "published test", "default"),
    ("attitude of a rolling ball", "object_motion", "frame of 21x21 dots",
     "published: ObjectMotion", "ObjectMotion, double, the default"),
    ("stick ratio", "stick_ratio", "frame of 21x21 dots", "published: StickRatio",
     "StickRatio, double, the default"),
    ("shift of a rigid contact", "contact_shift", "noise only", "central dot, published",
     "dots of the edge, the default"),
    ("lift of a modelled object", "foam_contact", "lift, 2000 steps",
     "published: printed, trapezoidal rule", "causal_response, the default"),
]


def machine(compiler):
    model = "unknown processor"
    for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            model = line.split(":", 1)[1].strip()
            break
    version = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=True)
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True,
                            check=False).stdout.strip()
    return (f"One core of {model}; {version.stdout.splitlines()[0]}; flags "
            f"{' and '.join(f'`{f}`' for f in FLAGS.values())}, besides `-std=c++20 -DNDEBUG`; "
            f"commit {commit}.")


def write_methods(build, docs, about):
    pictures = docs / "speed_and_error"
    pictures.mkdir(exist_ok=True)
    runs = {program: read({f: build / f"{program}_{f}.json" for f in FLAGS}) for program in METHODS}
    body = io.StringIO()
    for program, title in METHODS.items():
        body.write(f"\n## {title}\n")
        for group, rows in runs[program].items():
            print_group(group, rows, body)
    overview = [(label, runs[program][group][published], runs[program][group][ours])
                for label, program, group, published, ours in COMPARED]
    plots.summary(overview, pictures / "summary.png")
    replace_table(docs / "speed_and_error.md", "machine", about)
    replace_table(docs / "speed_and_error.md", "methods", body.getvalue())


def table(head, rows):
    """A table whose first column is left-aligned, the others right-aligned."""
    lines = [head, ["---"] + ["--:"] * (len(head) - 1), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines) + "\n"


def chain_stages(runs, chains):
    """Time of each stage, and its share of the frame; `runs` by flags."""
    def column(chain, run):
        of = run["chains"][chain]
        shares = [f"{number(ms, 3)} ({100 * ms / of['whole_ms']:.0f} %)"
                  for ms in of["stages_ms"].values()]
        return shares + [f"**{number(of['whole_ms'], 3)}**"]
    stages = [*next(iter(chains.values()))["stages_ms"], "**frame**"]
    columns = {f"{c}, {f}": column(c, run) for c in chains for f, run in runs.items()}
    return table(["ms, medians", *columns], zip(stages, *columns.values()))


def chain_errors(chains):
    def column(chain):
        errors = [" / ".join(number(e[s]) for s in ("median", "99 %", "worst"))
                  for e in chain["errors"].values()]
        return errors + [size(chain["bytes"]),
                         f"{size(chain['copy']['bytes'])}, {number(chain['copy']['again_ms'], 2)} ms"]
    quantities = [f"{q}, {e['unit']}" for q, e in next(iter(chains.values()))["errors"].items()]
    return table(["median / 99 % / worst", *chains],
                 zip([*quantities, "memory", "a copy"], *map(column, chains.values())))


def chain_latencies(runs):
    def row(flags, of):
        times = [number(of[k], 3) for k in ("median_ms", "99_ms", "999_ms", "worst_ms",
                                            "worst_of_thread_ms")]
        return [flags, *times, f"{of['frames_per_s']:.0f}", str(of["allocations"])]
    return table(["lean chain", "median, ms", "99 %", "99.9 %", "worst", "worst, processor time",
                  "frames a second", "allocations"],
                 [row(flags, run["latency"]) for flags, run in runs.items()])


def chain_samples(runs):
    def row(of):
        error = lambda quantity: " / ".join(number(of[-1]["errors"][quantity][s])
                                            for s in ("median", "99 %"))
        return [f"{of[0]['policies']}, {of[0]['step']} px", *(number(o["whole_ms"], 3) for o in of),
                *(error(q) for q in ("depth of a pixel", "contact area"))]
    return table(["chain, step", *(f"{flags}, ms" for flags in runs), "depth of a pixel, mm",
                  "contact area, share"],
                 map(row, zip(*(run["samples"] for run in runs.values()))))


def write_chain(build, docs, about):
    pictures = docs / "results"
    pictures.mkdir(exist_ok=True)
    runs = {name: json.loads((build / f"chain_{f}.json").read_text(encoding="utf-8"))
            for f, name in FLAGS.items()}
    runs = {"-O2": runs[FLAGS["o2"]], "native": runs[FLAGS["native"]]}
    chains = runs["native"]["chains"]
    plots.chain_stages(runs, pictures / "stages.png")
    for name, text in (("machine", about), ("chain_stages", chain_stages(runs, chains)),
                       ("chain_latencies", chain_latencies(runs)),
                       ("chain_errors", chain_errors(chains)), ("chain_samples", chain_samples(runs))):
        replace_table(docs / "results.md", name, text)
    replace_table(docs / "results.md", "worst_case", (build / "worst_case.md").read_text("utf-8"))


def replace_table(page, name, table):
    text = page.read_text(encoding="utf-8")
    pattern = rf"(<!-- table: {name} -->\n).*?(<!-- end -->)"
    page.write_text(re.sub(pattern, lambda m: m[1] + "\n" + table.strip() + "\n\n" + m[2], text,
                           flags=re.S), encoding="utf-8")


def main():
    build, docs = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    about = machine(sys.argv[3])
    write_methods(build, docs, about)
    write_chain(build, docs, about)
    replace_table(docs / "hard_cases.md", "hard_cases", (build / "hard_cases.md").read_text("utf-8"))
    for name in ("papers", "peers"):
        replace_table(docs / f"{name}.md", name, (build / f"{name}.md").read_text("utf-8"))
    plots.peers((build / "peers.md").read_text("utf-8"), docs / "peers.png")


if __name__ == "__main__":
    main()
