# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""The report's pictures."""
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogFormatterSciNotation  # noqa: E402
from PIL import Image  # noqa: E402

from runs import is_on_scenes  # noqa: E402

OURS, YARDSTICK = "#1f4e79", "#7f8c8d"
plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False,
                     "axes.grid": True, "grid.alpha": 0.25, "figure.dpi": 110})


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)
    with Image.open(path) as drawn:  # lines and letters need few colours
        drawn.convert("RGB").quantize(48, dither=Image.Dither.NONE).save(path, optimize=True)


def logarithmic(axis, name):
    """Labels between the powers of ten too, where these are few."""
    axis.axes.set(**{f"{name}scale": "log"})
    axis.set_minor_formatter(LogFormatterSciNotation(labelOnlyBase=False, minor_thresholds=(1.5, 0.6)))
    axis.set_tick_params(which="minor", labelsize=7)


def peers(tables, path):
    """A panel for each table of peers.md: time against error, from clean to the worst conditions."""
    sections = re.findall(r"### (.+?)\n(.+?)(?=\n### |\Z)", tables, re.S)
    figure, panels = plt.subplots(len(sections), 1, figsize=(8, 2.3 * len(sections)))
    for axes, (title, text) in zip(panels, sections):
        rows = [[c.strip() for c in line.strip("|").split("|")] for line in text.splitlines()
                if line.startswith("|") and not line.startswith(("|--", "| Method"))]
        for name, ms, *cells in rows:
            if name.startswith("the same"):
                continue
            colour = OURS if name.startswith("`") else YARDSTICK
            errors = [float(m[0]) for m in (re.match(r"[\d.]+", c) for c in cells) if m]
            lost = [float(m[1]) for m in (re.search(r"; ([\d.e+]+) %", c) for c in cells) if m]
            few = max(lost, default=0) < 5 and len(errors) == len(cells)
            axes.plot([float(ms)] * 2, [min(errors), max(errors)], color=colour, lw=1)
            axes.plot(float(ms), errors[0], "o", color=colour, mfc=colour if few else "white", ms=6)
            axes.annotate(name.replace("`", "").split(",")[0], (float(ms), errors[0]), textcoords="offset points",
                          xytext=(6, -11 if "Dot" in name else 14 if "LK" in name else 4), fontsize=7, color=colour)
        axes.set_title(title, loc="left", weight="bold")
        axes.set(xscale="log", yscale="log", ylabel="error, px")
        axes.margins(x=0.3, y=0.25)
        logarithmic(axes.xaxis, "x")
    figure.suptitle("Lower left is better: fast and accurate. Blue: fingerpad; grey: what users write with OpenCV", fontsize=10)
    panels[-1].set_xlabel("time of a frame, ms (dot: clean; line: all conditions; hollow: over 5 % lost in one)")
    save(figure, path)


def summary(methods, path):
    """Bars of the factors of speed and accuracy of ours: (label, published, ours).

    Hatched: not on finite-element scenes, but on a truth by a law that the method shares."""
    figure, axes = plt.subplots(figsize=(9, 0.42 * len(methods) + 1.5))
    better_colour, hatched = "#2e8b57", {"hatch": "////", "ec": "white", "lw": 0}
    for k, (_, published, ours) in enumerate(methods):
        y = len(methods) - k
        quantity = published.main_error()[0]
        faster = published.median("native") / ours.median("native")
        better = published.errors[quantity].high / ours.errors[quantity].high
        look = {} if is_on_scenes(quantity) else hatched
        for offset, ratio, colour, how in ((0.17, faster, OURS, {}), (-0.17, better, better_colour, look)):
            axes.barh(y + offset, ratio - 1, left=1, height=0.32, color=colour, **how)
            text = f"{ratio:.2g}x" if ratio < 100 else f"{ratio:.0f}x"
            axes.text(max(ratio, 1), y + offset, " " + text, va="center", fontsize=8)
    axes.set_xscale("log")
    axes.set_yticks(range(len(methods), 0, -1), [m[0] for m in methods])
    axes.axvline(1, color="black", lw=1)
    axes.set_xlabel("as published / fingerpad's default; bars to the left: slower, or less accurate")
    axes.barh(0, 0, color=OURS, label="times faster (-O3 -march=native)")
    axes.barh(0, 0, color=better_colour, label="times smaller error (99th percentile), finite-element scenes")
    axes.barh(0, 0, color=better_colour, **hatched, label="the same, synthetic truth by a law that both share")
    axes.set_ylim(0.4, len(methods) + 0.6)
    axes.margins(x=0.12)
    axes.legend(loc="upper center", bbox_to_anchor=(0.4, -0.16), ncol=1, frameon=False, fontsize=8)
    axes.set_title("Right of the line: the default is faster, or errs less, than the printed method", loc="left", fontsize=9)
    save(figure, path)


def chain_stages(runs, path):
    """Bars of the stages' medians; `runs` {flags: JSON of bench/report/chain.cpp}."""
    figure, axes = plt.subplots(figsize=(9, 3.2))
    bars = [(f"{name}, {flags}", run["chains"][name]["stages_ms"])
            for name in next(iter(runs.values()))["chains"] for flags, run in runs.items()]
    colours = plt.get_cmap("tab10").colors
    for y, (name, stages) in enumerate(reversed(bars)):
        left = 0
        for k, (stage, ms) in enumerate(stages.items()):
            axes.barh(y, ms, left=left, color=colours[k], label=stage if y == 0 else None)
            left += ms
        axes.text(left, y, f" {left:.2f} ms", va="center", fontsize=8)
    axes.set_yticks(range(len(bars)), [name for name, _ in reversed(bars)])
    axes.set_xlabel("ms a frame of 640 x 480, one thread (medians)")
    axes.set_title("Depth and contact take most of a frame", loc="left", fontsize=10, pad=24)
    axes.legend(ncol=4, fontsize=8, frameon=False, loc="lower center", bbox_to_anchor=(0.45, 1))
    axes.margins(x=0.1)
    save(figure, path)
