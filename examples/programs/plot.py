#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Draws charts of what replay wrote: plot.py DIR [RECORDING], into DIR/pictures.

Lines end where there is no answer; a band is two standard deviations; grey is where the status is
in doubt. RECORDING adds the true forces of its forces.csv, dashed, and the readings of its taxels.
plot.py --calibrations DIR draws the tables of `calibrate ... --plots DIR` instead.
"""
import csv
import math
import os
import pathlib
import sys

try:
    import matplotlib
except ImportError:
    sys.exit("plot.py draws with matplotlib, which this Python does not have: "
             "pip install matplotlib, or apt install python3-matplotlib and /usr/bin/python3 plot.py")
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

plt.rcParams.update({"font.size": 9, "axes.grid": True, "grid.alpha": 0.25, "legend.frameon": False,
                     "axes.spines.top": False, "axes.spines.right": False, "figure.dpi": 100})


def read(file):
    """The columns of a table; numbers where a column has nothing else."""
    with open(file, newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    columns = {name: [row[name] or "" for row in rows] for name in (rows[0] if rows else {})}
    for name, cells in columns.items():
        try:
            columns[name] = [float(cell) if cell else math.nan for cell in cells]
        except ValueError:
            pass
    return columns


def known(table, *names):
    return any(name in table and any(x == x and x != "" for x in table[name]) for name in names)


def chart(title, panels, table, to, doubt=None, limits=None):
    """Panels of (label, [(name, values, sd or None, truth or None)]), one above the other."""
    x = table["frame"]
    doubted = [f for f, status in zip(x, table.get(doubt, [])) if status not in ("ok", "no contact", "")]
    figure, axes = plt.subplots(len(panels), 1, sharex=True, squeeze=False,
                                figsize=(8, 0.8 + 1.7 * len(panels)), layout="constrained")
    for ax, (label, curves) in zip(axes[:, 0], panels):
        for k, (name, y, sd, truth) in enumerate(curves):
            line, = ax.plot(x, y, ".-", ms=3, color=f"C{k}", label=name)
            if sd:
                ax.fill_between(x, [a - 2 * s for a, s in zip(y, sd)],
                                [a + 2 * s for a, s in zip(y, sd)], color=line.get_color(), alpha=0.2, lw=0)
            if truth:
                ax.plot(*truth, "--", color=line.get_color(), lw=1)
        for frame in doubted:
            ax.axvspan(frame - 0.5, frame + 0.5, color="0.85", lw=0, zorder=0)
        ax.set_ylabel(label)
        if len(curves) > 1:
            ax.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    axes[-1, 0].set_xlabel("frame")
    axes[0, 0].set_ylim(limits)
    figure.suptitle(title + ("; grey: in doubt" if doubted else ""), fontsize=10)
    figure.savefig(to)
    plt.close(figure)


def scaled(values, by):
    return [by * v for v in values]


def pad(table, truth, pictures):
    first = {}  # place at which each object was begun
    moved = {axis: [] for axis in "xyz"}
    for k, number in enumerate(table["object"]):
        for axis in "xyz":
            at = table[f"object_{axis}_mm"][k]
            if at == at:
                first.setdefault((number, axis), at)
            moved[axis].append(at - first.get((number, axis), math.nan))
    if known(table, "contact_area_mm2"):
        degrees = {axis: scaled(table[f"rotation_{axis}_rad"], 180 / math.pi) for axis in "xyz"}
        chart("Contact, and motion of the object since it began; lines end where it slides",
              [("area, mm$^2$", [("", table["contact_area_mm2"], table["contact_area_sd_mm2"], None)]),
               ("depth, mm", [("", table["contact_depth_mm"], None, None)]),
               ("moved, mm", [(a, moved[a], table["object_sd_mm"], None) for a in "xyz"]),
               ("turned, degrees", [(f"about {a}", degrees[a], scaled(table["rotation_sd_rad"], 180 / math.pi), None)
                                    for a in "xyz"])],
              table, pictures / "motion.png", "motion_status")
    if known(table, "stick_ratio"):
        new = [r if u == 1 else math.nan for r, u in zip(table["stick_ratio"], table["stick_ratio_updated"])]
        chart("Stick ratio: 1 all dots stick, 0 the object slides. Orange: new answers; the band grows while one is kept",
              [("stick ratio", [("kept", table["stick_ratio"], table["stick_ratio_sd"], None), ("new", new, None, None)]),
               ("dots in contact", [("", table["dots_in_contact"], None, None)])],
              table, pictures / "stick_ratio.png", limits=(-0.05, 1.05))
    true = lambda name, sign=1, by=1: (truth["frame"], scaled(truth[name], sign * by)) if name in truth else None
    if known(table, "normal_force_n", "tangential_force_x_n"):
        chart("Forces by look-up" + (" (dashed: true)" if truth else ""),
              [("pressed, N", [("", table["normal_force_n"], table["normal_force_sd_n"], true("force_z_n", -1))]),
               ("along the pad, N", [(a, table[f"tangential_force_{a}_n"], None, true(f"force_{a}_n")) for a in "xy"]),
               ("moment, N mm", [("", scaled(table["moment_z_nm"], 1000), None, None)])],
              table, pictures / "forces.png", "look_up_status")
    if known(table, "wrench_fz_n"):
        chart("Six axes: what the object exerts on the pad, about the plate's centre" + (" (dashed: true)" if truth else ""),
              [("force, N", [(f"F$_{a}$", table[f"wrench_f{a}_n"], table[f"wrench_f{a}_sd_n"], true(f"force_{a}_n"))
                             for a in "xyz"]),
               ("moment, N mm", [(f"M$_{a}$", scaled(table[f"wrench_m{a}_nm"], 1000),
                                  scaled(table[f"wrench_m{a}_sd_nm"], 1000), true(f"moment_{a}_nm", by=1000))
                                 for a in "xyz"])],
              table, pictures / "wrench.png", "wrench_status")


def gel(table, pictures):
    slips = [f for f, s in zip(table["frame"], table["slip"]) if s == 1]
    touches = any(area > 0 for area in table["contact_area_px"])
    chart("Slide of the contact past the dots: " + (f"it slips from frame {slips[0]:.0f} on" if slips else
                                                    "no slip" if touches else "no contact was seen"),
          [("evidence; above 1: slip", [("", table["slide_evidence"], None, None)]),
           ("slid, pitches", [("", table["slide_pitches"], None, None)]),
           ("contact, px", [("", table["contact_area_px"], None, None)])],
          table, pictures / "slide.png", "slide_status")


def foam(table, pictures):
    fingers = sorted({name.split("_")[0] + "_" for name in table if name.startswith("finger")}) or [""]
    alarms = [f for f, alarm in zip(table["frame"], table["preslip"]) if alarm == 1]
    shown = lambda column: [(f.strip("_"), table[f + column], None, None) for f in fingers]
    chart("Foam fingers: " + (f"first warning in frame {alarms[0]:.0f} (lowest panel)" if alarms else "no warning"),
          [("force, N", shown("force_n")) if fingers[0] + "force_n" in table else ("sum", shown("sum")),
           ("centroid y, mm", shown("center_y_mm")),
           ("vibration, Hz", shown("frequency_hz")), ("warning", [("", table["preslip"], None, None)])],
          table, pictures / "preslip.png")


def array(table, taxels, pictures):
    """The array at seven times around the first warning: readings, and vibration of each taxel."""
    frames = [int(f) for f in taxels["frame"]]
    cells = {tuple(int(p[1:]) for p in name.split("_")): values for name, values in taxels.items() if name[0] == "r"}
    rows, cols = (max(c[k] for c in cells) + 1 for k in (0, 1))
    alarm = next((int(f) for f, a in zip(table["frame"], table["preslip"]) if a == 1), frames[len(frames) // 2])
    at = [k for k in (frames.index(alarm) + d for d in range(-24, 25, 8)) if 16 <= k < len(frames)]
    if not at:
        return
    def rms(values):  # about the line through them
        n = len(values)
        mean, middle = sum(values) / n, (n - 1) / 2
        slope = sum((i - middle) * v for i, v in enumerate(values)) * 12 / (n * (n * n - 1))
        return math.sqrt(sum((v - mean - slope * (i - middle)) ** 2 for i, v in enumerate(values)) / n)
    figure, axes = plt.subplots(2, len(at), squeeze=False, figsize=(1.2 * len(at), 5), layout="constrained")
    for j, k in enumerate(at):
        grids = [[[cells[r, c][k] for c in range(cols)] for r in range(rows)],
                 [[rms(cells[r, c][k - 15:k + 1]) for c in range(cols)] for r in range(rows)]]
        for ax, grid, colours, most in zip(axes[:, j], grids, ("viridis", "Reds"), (None, 60)):
            ax.imshow(grid, cmap=colours, vmin=0, vmax=most)
            ax.set(xticks=[], yticks=[])
            ax.grid(False)
        axes[0, j].set_title(f"frame {frames[k]}" + ("\nwarning" if frames[k] == alarm else ""), fontsize=9,
                             color="C3" if frames[k] == alarm else "k")
    axes[0, 0].set_ylabel("readings")
    axes[1, 0].set_ylabel("vibration in 16 samples")
    figure.suptitle("Each taxel around the first warning: vibration (red) begins before the load moves", fontsize=10)
    figure.savefig(pictures / "array.png")
    plt.close(figure)


def calibrations(folder):
    for file in sorted(folder.glob("*.csv")):
        with open(file, newline="", encoding="utf-8") as stream:
            rows = list(csv.reader(stream))
        x, measured, fitted = zip(*sorted(tuple(map(float, row)) for row in rows[1:]))
        y_name = os.path.commonprefix(rows[0][1:3]).strip()
        figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(7, 5), height_ratios=(3, 1),
                                              layout="constrained")
        for y, mark, name in ((measured, ".", rows[0][1]), (fitted, "k_", rows[0][2])):
            above.plot(x, y, mark, label=name.removeprefix(y_name).strip())
        above.set(ylabel=y_name, title=file.stem.replace("_", " ") + ": measured and fitted; the difference should scatter about 0")
        above.legend()
        below.plot(x, [m - f for m, f in zip(measured, fitted)], ".", ms=4)
        below.set(xlabel=rows[0][0], ylabel="difference")
        figure.savefig(file.with_suffix(".png"))
        plt.close(figure)


def main(arguments):
    if arguments[:1] == ["--calibrations"] and len(arguments) == 2:
        return calibrations(pathlib.Path(arguments[1]))
    if not 1 <= len(arguments) <= 2 or arguments[0].startswith("-"):
        sys.exit(__doc__)
    folder, recording = pathlib.Path(arguments[0]), pathlib.Path(arguments[-1])
    pictures = folder / "pictures"
    pictures.mkdir(exist_ok=True)
    table = read(folder / "frames.csv")
    if "preslip" in table:
        foam(table, pictures)
        if (recording / "taxels.csv").exists():
            array(table, read(recording / "taxels.csv"), pictures)
        return
    pad(table, read(recording / "forces.csv") if (recording / "forces.csv").exists() else {}, pictures)
    if known(table, "slip"):
        gel(table, pictures)


if __name__ == "__main__":
    main(sys.argv[1:])
