# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Results of the benchmarks: Google Benchmark JSON of one program with both sets of flags."""
import json
from dataclasses import dataclass, field

FLAGS = {"o2": "-O2", "native": "-O3 -march=native"}
SECONDS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


@dataclass
class Error:
    unit: str
    median: float
    high: float  # 99th percentile
    worst: float


@dataclass
class Row:
    name: str
    seconds: dict = field(default_factory=dict)  # {flags: sorted seconds of each repetition}
    errors: dict = field(default_factory=dict)   # {quantity: Error}, the main one first
    found: dict = field(default_factory=dict)    # {quantity: share that has an answer, if not all}
    bytes: float = 0
    allocations: float = 0
    pixels: float = 1

    def median(self, flags):
        times = self.seconds[flags]
        return times[len(times) // 2]

    def spread(self, flags):
        """Half the distance between the 10th and the 90th percentile, relative to the median."""
        times = self.seconds[flags]
        at = lambda share: times[round(share * (len(times) - 1))]
        return (at(0.9) - at(0.1)) / 2 / self.median(flags)

    @property
    def is_published(self):
        return "published" in self.name

    @property
    def is_yardstick(self):
        return self.name.startswith(("streaming", "cv::"))

    def main_error(self):
        """First error on finite-element scenes, whose truth no method makes, else the first."""
        on_scenes = [(q, e) for q, e in self.errors.items() if is_on_scenes(q)]
        return next(iter(on_scenes or self.errors.items()), (None, None))


def is_on_scenes(quantity):
    return quantity.endswith(" on scenes")


def main_quantity(rows):
    """(quantity, Error) that represents a group; on finite-element scenes if a row has it."""
    mains = [r.main_error() for r in rows if r.errors]
    return next((m for m in mains if is_on_scenes(m[0])), next(iter(mains), (None, None)))


def read_errors(row, benchmark):
    parts = {}
    for key, value in benchmark.items():
        if key.startswith("error|"):
            _, quantity, unit, statistic = key.split("|")
            parts.setdefault((quantity, unit), {})[statistic] = value
        elif key.startswith("found|"):
            row.found[key.split("|")[1]] = value
    for (quantity, unit), of in parts.items():
        row.errors[quantity] = Error(unit, of["median"], of["99 %"], of["worst"])


def read(paths):
    """{group: {name: Row}} in the order of the program; `paths` {flags: file}."""
    groups = {}
    for flags, path in paths.items():
        with open(path, encoding="utf-8") as file:
            run = json.load(file)
        for b in sorted(run["benchmarks"], key=lambda b: b["family_index"]):
            if b.get("run_type") == "aggregate":
                continue
            group, name = b["run_name"].split("/", 1)
            row = groups.setdefault(group, {}).setdefault(name, Row(name))
            seconds = b["cpu_time"] * SECONDS[b["time_unit"]]
            row.seconds.setdefault(flags, []).append(seconds)
            row.bytes, row.allocations = b["bytes"], b["allocations"]
            row.pixels = b["pixels/s"] * seconds
            if not row.errors:
                read_errors(row, b)
    for rows in groups.values():
        for row in rows.values():
            for times in row.seconds.values():
                times.sort()
    return groups
