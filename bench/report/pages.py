#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Writes the report: pages.py BUILD DOCS COMPILER, from the results in BUILD.

docs/speed_and_error.md and docs/whole_chain.md with their pictures, and the tables within
docs/hard_cases.md, docs/papers.md and docs/what_a_scene_needs.md.
"""
import csv
import io
import json
import pathlib
import re
import subprocess
import sys

import plots
from runs import FLAGS, read
from tables import number, print_group, size

# {program: (heading, groups with a picture)}
METHODS = {
    "depth": ("Depth: inversion", ["full pad, depths up to 14 mm"]),
    "frame": ("Depth: the whole step", ["round pad"]),
    "smoothing": ("Depth: averaging", ["two planes"]),
    "neighbour_light": ("Neighbour light", ["radius 15 px"]),
    "optics": ("Optics", ["virtual heights", "point"]),
    "curvature": ("Curvature", ["round pad, radius 10 px"]),
    "contact_region": ("Contact region", ["350 mm^2"]),
    "object_surface": ("Object surface", ["rays"]),
    "object_motion": ("Motion of the object", ["frame of 21x21 dots"]),
    "stick_ratio": ("Stick ratio", ["frame of 21x21 dots"]),
    "spatial_stick_ratio": ("Stick ratio in space", []),
    "gel_slide": ("Gel slide", []),
    "grip_control": ("Grip control", ["closed loop"]),
    "wrench": ("Six axes from dots in the picture", ["frame of 250 dots"]),
    "traction": ("Traction", ["frame of 21x21 dots"]),
    "normal_force": ("Normal force", ["one frame, double"]),
    "contact_shift": ("Shift of the contact", ["noise only", "stuck dots"]),
    "shear": ("Tangential force and moment", ["4096 contacts"]),
    "taxel_features": ("Taxel features", ["vibrating, window 16"]),
    "preslip": ("Pre-slip", ["detection"]),
    "dot_finder": ("Printed dots", ["21x21 dots, radius 4.4 px"]),
    "foam_contact": ("Foam contact", ["steps", "lift, 2000 steps"]),
    "calibrations": ("Calibrations", []),
}
# {program: what its tables do not say themselves}
NOTES = {
    "neighbour_light": """The disc is summed exactly, row by row, so that the time grows with its radius. At full
resolution and 30 px that takes three times as long as the five rectangles which stood for the disc at commit
ec8bb89. `Fingertip` takes the light off samples of 3 x 3 pixels.""",
    "spatial_stick_ratio": """"On scenes": ten finite-element scenes, six times each; the limit is that of
dragged plates, as a share of the coefficient of friction.""",
    "calibrations": """Times are those of a fit. "A sensor of numbers": errors of each parameter over 100 fits
with fresh noise ([what each is](calibrate/calibration.md#the-covariance-tried)). "On scenes": errors of the
method, on finite-element scenes that were left out of the fit.""",
}
# The published method against the default: (label, program, group, published row, our row).
COMPARED = [
    ("depth of a pixel, rendered", "depth", "full pad, depths up to 14 mm", "published bisection, double",
     "exponential-free float <3, 6>"),
    ("depth of a noisy frame, rendered", "frame", "round pad", "published: BoxMean + Bisection in double",
     "BiasFreeMean + ExponentialFree<>"),
    ("curvature of caps", "curvature", "round pad, radius 10 px", "published circle, double",
     "clamped mean, float, through a camera, the default"),
    ("contact's area", "contact_region", "350 mm^2", "published test", "default, with its gap"),
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
    for program, (title, plotted) in METHODS.items():
        body.write(f"\n## {title}\n")
        if program in NOTES:
            body.write(f"\n{NOTES[program]}\n")
        for group, rows in runs[program].items():
            if group in plotted:
                k = plotted.index(group)
                name = f"{program}_{k + 1}.png" if k else f"{program}.png"
                plots.pareto(f"{title}: {group}", rows, pictures / name)
                body.write(f"\n![{title}, {group}: time against error](speed_and_error/{name})\n")
            print_group(group, rows, body)
    overview = [(label, runs[program][group][published], runs[program][group][ours])
                for label, program, group, published, ours in COMPARED]
    plots.summary(overview, pictures / "summary.png")
    (docs / "speed_and_error.md").write_text(f"""# Speed against error

Every method, every choice and every scalar: what a frame costs and how far it is from the truth, on
the same inputs. Written by `bench/report/run`, which builds and runs all of `bench/`.

{about}

![fingerpad's default against the published way](speed_and_error/summary.png)

How to read it. Times are medians over repetitions, with half the distance of the 10th and the 90th
percentile; "ns per item" is the native time over the number of pixels, samples or frames of a call,
and "times as fast" compares with the first row, both at the native flags. Errors are the
**median / 99th percentile / worst** of everything that was compared, and of how many if not all have
an answer. Errors "on scenes" are against finite-element membranes. Their rubber is neo-Hookean or
Mooney-Rivlin, as the pull at the rim supposes too; they share no other law with a method. All other
errors are against truths made by the law of the method: light by the model that is inverted, caps,
rigid motions, films. Where a method has the one kind, pictures and first tables show that. Memory is
what a row's estimator, workspace, state and outputs take; allocations are those of one call. "over"
columns give the native time over that of a yardstick in the same run: OpenCV's nearest primitive, or
one streaming pass over four planes of 640 x 480 floats. In the pictures a star is the published way,
the dotted line joins the ways that nothing beats in both time and error, and dashed lines are
yardsticks. What is timed and what the truth is stands on top of each `bench/*/*.cpp`.
The [whole chain](whole_chain.md), [hard cases](hard_cases.md) and [what a scene
needs](what_a_scene_needs.md) have pages of their own.
{body.getvalue()}""", encoding="utf-8")


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
                *(error(q) for q in ("depth of a pixel", "contact area", "F_z", "M_z"))]
    return table(["policies, step", *(f"{flags}, ms" for flags in runs), "depth of a pixel, mm",
                  "contact area, share", "F_z, share", "M_z, N mm"],
                 map(row, zip(*(run["samples"] for run in runs.values()))))


def chain_events(runs):
    def told(of):
        return of and all(of.values())
    rows = [[f"{name}, {flags}", *(f"{of['events'][e] / 1e6:.3g}" for e in ("instructions", "cycles"))]
            for flags, run in runs.items() for name, of in run["chains"].items()
            if told(of["events"])]
    if not rows:
        return "This machine does not tell how many instructions and cycles a frame takes.\n"
    return table(["a frame", "million instructions", "million cycles"], rows)


def chain_passes(runs):
    columns = {f"{chain}, {flags}": of for flags, run in runs.items()
               for chain, of in run["passes_ms"].items()}
    passes = next(iter(columns.values()))
    return table(["us, medians", *columns],
                 [[name, *(number(1000 * of[name], 3) for of in columns.values())]
                  for name in passes])


def write_chain(build, docs, about):
    pictures = docs / "whole_chain"
    pictures.mkdir(exist_ok=True)
    runs = {name: json.loads((build / f"chain_{f}.json").read_text(encoding="utf-8"))
            for f, name in FLAGS.items()}
    runs = {"-O2": runs[FLAGS["o2"]], "native": runs[FLAGS["native"]]}
    plots.chain_stages(runs, pictures / "stages.png")
    plots.chain_samples([(o["policies"], o["step"], o["whole_ms"],
                          o["errors"]["depth of a pixel"]["99 %"])
                         for o in runs["native"]["samples"]], pictures / "samples.png")
    plots.chain_latencies(runs, pictures / "latency.png")
    plots.chain_growth(runs["native"], pictures / "growth.png")
    chains = runs["native"]["chains"]
    count = runs["native"]["latency"]["frames"]
    (docs / "whole_chain.md").write_text(f"""# The whole chain

A frame in, all results out: 640 x 480 pixels of red and green, two planes of 8 bit, to smoothing,
depth, contact region, motion of the object, stick ratio, look-up forces and six-axis force, put
together in
[pipeline/fingertip.hpp](../include/fingerpad/pipeline/fingertip.hpp); the dots are given. Written by
`bench/report/run`.

{about}

Two chains. **default**: the methods by default. **lean**: what a flat contact on a pad with dark dots
cannot do without: no placed edge, in samples of 4 x 4 pixels where the other has 3 x 3.

![Time of each stage](whole_chain/stages.png)

What each stage adds to the time of a frame:

{chain_stages(runs, chains)}
{chain_events(runs)}
## Samples

What is averaged over 29 px need not be worked on at every pixel
([samples](depth/depth.md#samples)). Time against error by step, 16 frames, median / 99 %:

![Time over the error of depth, by step and policies](whole_chain/samples.png)

{chain_samples(runs)}
The frame is read once, for the samples, and the samples a second time, for the depth. One pass over both
could save no more than a copy of the samples takes, because they stay in the cache:

{chain_passes(runs)}
## Vectors

The pixel kernels use the widest vectors that the compiler's flags allow. Instructions a call takes at `-O2`, on
a frame of 320 x 240 pixels and its depths: valgrind counts those of x86-64, and qemu executes those of aarch64.
Without vectors, `FINGERPAD_NO_VECTORS` is defined. Repeat: `bench/report/run instructions`. Results in all of
them agree ([modes](hardening.md#modes)).

{(build / "instructions.md").read_text(encoding="utf-8")}
Samples of 3 x 3 use 16-byte vectors everywhere, since each call works on three of them.

## Error

16 frames of a membrane in equilibrium under a plate that drags its dots to and fro and turns them,
one grey level of noise; every result has its truth (bench/report/chain/pressed_frames.hpp).

{chain_errors(chains)}
The contact's area is that of a region whose gap of 20 um counts as touched, and of depths that were
averaged over 29 px; [contact region](contact/contact_region.md) says what each does to it. Look-up forces
follow the area.

## Latency

{count} frames of the lean chain, one after another, in one thread. Results are the same to the last bit from
run to run (`tests/pipeline/fingertip.cpp`). A frame that takes several times the median was interrupted: the core
went to another process, or a virtual machine's host took it. The processor time is that of the thread; the host's
share remains in it.

![Share of frames that take longer](whole_chain/latency.png)

{chain_latencies(runs)}
## Growth

Windows and rings are as wide on the pad, whatever the size of the image.

![Time over the size of the image, the number of dots, and the length of the history](whole_chain/growth.png)
""", encoding="utf-8")


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
    replace_table(docs / "hard_cases.md", "worst_case", (build / "worst_case.md").read_text("utf-8"))
    replace_table(docs / "papers.md", "papers", (build / "papers.md").read_text("utf-8"))
    replace_table(docs / "what_a_scene_needs.md", "ablation",
                  (build / "ablation.md").read_text("utf-8"))
    with open(build / "ablation.csv", encoding="utf-8") as file:
        plots.ablation(list(csv.DictReader(file)), docs / "what_a_scene_needs.png")


if __name__ == "__main__":
    main()
