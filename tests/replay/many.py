#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Tests the program replay_many as a laboratory uses it.

many.py PROGRAM PRESS [--mpirun FILE] [--recordings N] [--kills N]

1. N small recordings, some of them broken. One process and several, 1, 2 (with more than one kill)
   and 4 ranks write the same bytes. Only the broken recordings are reported, each with its reason.
2. Kills of a unit's process, a rank, the leader, or mpirun with all processes, at N random moments
   each. The same command continues, the final result is the same as without kills, and no finished
   recording is processed again. With --kills 1, one process is killed as the leader only, and three
   ranks as a unit, a rank and all.
3. A full disk and missing recordings are reported and survived.
"""
import argparse
import csv
import filecmp
import json
import os
import random
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

BROKEN = {
    "broken_no_sensor": "sensor.json",
    "broken_json": "sensor.json",
    "broken_frame": "frames/000001.png",
    "broken_no_frames": "frames",
    "broken_taxels": "taxels.csv",
    "broken_unreadable": "sensor.json",
}


def write_foam(folder, seed):
    """An array of 3 x 3 taxels that rests and then vibrates."""
    chance = random.Random(seed)
    folder.mkdir(parents=True)
    lines = ["frame,time_s," + ",".join(f"r{k // 3}_c{k % 3}" for k in range(9))]
    for n in range(60 + 10 * (seed % 7)):
        noise = 3 if n < 40 else 20
        taxels = (str(round(600 + 50 * k + chance.gauss(0, noise))) for k in range(9))
        lines.append(f"{n},{n / 30:.4f}," + ",".join(taxels))
    (folder / "taxels.csv").write_text("\n".join(lines) + "\n")


def write_press(folder, press, frames, with_dots):
    """The bundled recording, reduced to these frames."""
    (folder / "frames").mkdir(parents=True)
    for k, frame in enumerate(frames):
        (folder / f"frames/{k:06d}.png").symlink_to(press / f"frames/{frame:06d}.png")
    for name in ("reference.png", "reference_depth.tiff"):
        (folder / name).symlink_to(press / name)
    sensor = json.loads((press / "sensor.json").read_text())
    if not with_dots:
        for section in ("dots", "rim"):
            del sensor[section]
    (folder / "sensor.json").write_text(json.dumps(sensor))


def png_of_one_pixel():
    """A picture of another size than the reference; one that is damaged would be left out."""

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)
    pixel = zlib.compress(bytes(4))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        chunk(*part) for part in ((b"IHDR", head), (b"IDAT", pixel), (b"IEND", b""))
    )


def write_recordings(folder, press, count):
    """`count` good recordings and the broken ones; one has a comma and a quote, one is nested."""
    chance = random.Random(count)
    for k in range(count - 3):
        write_foam(folder / f"{['left', 'right'][k % 2]}/foam_{k:04d}", k)
    write_foam(folder / 'of "today", the last', 1000)
    write_press(folder / "press_dots", press, range(3), True)
    write_press(folder / "press_long", press, [chance.randrange(11) for _ in range(3)], False)
    (folder / "broken_no_sensor").mkdir()
    write_press(folder / "broken_json", press, [1], False)
    (folder / "broken_json/sensor.json").write_text('{ "camera": ')
    write_press(folder / "broken_frame", press, [1, 2, 3], False)
    (folder / "broken_frame/frames/000001.png").unlink()
    (folder / "broken_frame/frames/000001.png").write_bytes(png_of_one_pixel())
    write_press(folder / "broken_no_frames", press, [1], False)
    shutil.rmtree(folder / "broken_no_frames/frames")
    write_foam(folder / "broken_taxels", 3)
    (folder / "broken_taxels/taxels.csv").write_text("frame,time_s,r0_c0\n0,0,half\n")
    write_press(folder / "broken_unreadable", press, [1], False)
    (folder / "broken_unreadable/sensor.json").unlink()
    (folder / "broken_unreadable/sensor.json").symlink_to(folder / "nowhere")


def files_of(folder):
    """All files below `folder`, except those of the run itself."""
    own = ("lock", "aside", "options.txt")
    return {
        p.relative_to(folder)
        for p in folder.rglob("*")
        if p.is_file() and p.relative_to(folder).parts[0] not in own
    }


def differences(one, other):
    found = [f"only in one: {p}" for p in files_of(one) ^ files_of(other)]
    for name in files_of(one) & files_of(other):
        if not filecmp.cmp(one / name, other / name, shallow=False):
            found.append(f"differs: {name}")
    return sorted(found)


class Test:
    def __init__(self, arguments, work):
        self.program = arguments.program.resolve()
        self.mpirun = arguments.mpirun
        self.work = work
        self.kills = arguments.kills
        self.good = arguments.recordings
        self.failures = 0
        self.recordings = work / "recordings"
        write_recordings(self.recordings, arguments.press.resolve(), self.good)

    def expect(self, holds, what):
        if not holds:
            print(f"FAILED: {what}", flush=True)
            self.failures += 1

    def command(self, out, ranks, *more):
        # Maps instead of pictures: also files of single frames, but faster to make.
        how = ["--no-pictures", "--raw", *more]
        ours = [str(self.program), str(self.recordings), "--out", str(out), *how]
        if ranks == 0:
            return ours
        # The ranks of a test share the available cores.
        return [self.mpirun, "-n", str(ranks), "--oversubscribe", "--allow-run-as-root", *ours]

    def run(self, out, ranks, *more, status=1):
        begin = time.monotonic()
        done = subprocess.run(self.command(out, ranks, *more), capture_output=True, text=True)
        self.expect(
            done.returncode == status, f"status {done.returncode}, not {status}: {done.stderr}"
        )
        return time.monotonic() - begin, done.stderr

    def check_whole(self, out):
        with open(out / "summary.csv", newline="") as file:
            rows = {row["recording"]: row for row in csv.DictReader(file)}
        self.expect(len(rows) == self.good + len(BROKEN), f"{len(rows)} recordings")
        for name, row in rows.items():
            self.expect((row["status"] == "failed") == (name in BROKEN), f"{name}: {row['status']}")
            self.expect(BROKEN.get(name, "") in row["reason"], f"{name}: {row['reason']}")
        with open(out / "all_frames.csv", newline="") as file:
            lines = [(row["recording"], row["frame"]) for row in csv.DictReader(file)]
        self.expect(len(lines) == len(set(lines)), "a frame is in all_frames.csv twice")
        self.expect(len(lines) == sum(int(row["frames"]) for row in rows.values()), "frames lack")
        left = [p for p in out.glob("aside/**/*") if p.is_file()]
        self.expect(not left, f"left behind: {left}")

    def same_bytes(self):
        self.one = self.work / "one"
        seconds, _ = self.run(self.one, 0, "--jobs", "1")
        self.check_whole(self.one)
        print(f"{self.good} recordings, 1 process: {seconds:.1f} s", flush=True)
        others = {"2 processes": (0, "--jobs", "2")}
        if self.mpirun:
            others |= {f"{n} ranks": (n,) for n in ((1, 4) if self.kills == 1 else (1, 2, 4))}
        for name, how in others.items():
            out = self.work / "other"
            seconds, _ = self.run(out, *how)
            print(f"{name}: {seconds:.1f} s", flush=True)
            for difference in differences(self.one, out):
                self.expect(False, f"{name}: {difference}")
            shutil.rmtree(out)

    def processes(self, started):
        """Processes of a run: leader, other ranks, processes of units; `all` adds mpirun's."""
        parents, words, leads = {}, {}, {}
        for entry in Path("/proc").iterdir():
            try:
                stat = (entry / "stat").read_text()
                words[int(entry.name)] = (entry / "cmdline").read_bytes().split(b"\0")
                variables = (entry / "environ").read_bytes().split(b"\0")
            except (OSError, ValueError):
                continue
            parents[int(entry.name)] = int(stat.rpartition(")")[2].split()[1])
            rank = [v for v in variables if v.startswith(b"OMPI_COMM_WORLD_RANK=")]
            leads[int(entry.name)] = rank in ([], [b"OMPI_COMM_WORLD_RANK=0"])
        ours = {started}
        while more := {p for p, parent in parents.items() if parent in ours} - ours:
            ours |= more
        kinds = {"leader": [], "rank": [], "unit": [], "all": sorted(ours)}
        for p in sorted(ours & set(leads)):
            if b"--unit" in words[p][:2]:
                kinds["unit"].append(p)
            elif words[p][0] == bytes(self.program):
                kinds["leader" if leads[p] else "rank"].append(p)
        return kinds

    def killed_at_random(self, ranks, kind, seconds):
        """Kills and restarts until a run ends; each recording is processed once."""
        chance = random.Random(f"{ranks} {kind}")
        out = self.work / "killed"
        kills, runs, hung, done = 0, 0, 0, {}
        if self.kills == 0:
            return
        while kills < self.kills:
            process = subprocess.Popen(
                self.command(out, ranks),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
            )
            runs += 1
            while process.poll() is None and kills < self.kills:
                time.sleep(chance.uniform(0.0, seconds))
                victims = self.processes(process.pid)[kind]
                if victims and process.poll() is None:
                    try:
                        # All: as in a power failure.
                        for victim in victims if kind == "all" else [chance.choice(victims)]:
                            os.kill(victim, signal.SIGKILL)
                        kills += 1
                    except ProcessLookupError:
                        continue
                if kind != "unit":
                    break
            try:
                process.wait(timeout=60 if ranks > 0 and kind != "unit" else None)
            except subprocess.TimeoutExpired:  # mpirun deadlocks (Open MPI 4.1.4)
                process.kill()
                process.wait()
                hung += 1
            # The processes of units die with their parent.
            self.wait_until_gone(out)
            done = self.expect_kept(out, done)
            if process.returncode == 1 and kills < self.kills:  # the run ended: start again
                self.go_on(out, ranks, kind)
                done = {}
        self.go_on(out, ranks, kind)
        print(f"{kills} kills of {kind}, {ranks} ranks, {runs} runs", flush=True)
        if hung > 0:
            print(f"after {hung} of them mpirun itself hung, and was killed", flush=True)

    def go_on(self, out, ranks, kind):
        """Runs to the end. A unit killed three times is reported and retried on request."""
        for file in (out / "failed").rglob("*.txt"):
            killed = "its process died: Killed, 3 times" in file.read_text()
            self.expect(killed or file.stem in BROKEN, f"{file}: {file.read_text()}")
        self.run(out, ranks, "--retry")
        self.expect_like_one(out, kind)
        shutil.rmtree(out)

    def wait_until_gone(self, out):
        needle = str(out).encode()
        for _ in range(500):
            alive = 0
            for entry in Path("/proc").iterdir():
                try:
                    alive += needle in (entry / "cmdline").read_bytes()
                except OSError:
                    continue
            if alive == 0:
                return
            time.sleep(0.02)
        self.expect(False, "processes outlive their run")

    def expect_kept(self, out, before):
        """Checks that finished results are unchanged: the folders and the times of their tables."""
        now = {}
        for table in (out / "recordings").rglob("frames.csv"):
            now[table] = (table.stat().st_ino, table.stat().st_mtime_ns)
        for table, stat in before.items():
            self.expect(now.get(table) == stat, f"lost or done twice: {table}")
        return now

    def expect_like_one(self, out, kind):
        for difference in differences(self.one, out):
            self.expect(False, f"kills of {kind}: {difference}")

    def full_disk(self):
        """A file system of 300 KiB, if the user may mount one."""
        out = self.work / "full"
        out.mkdir()
        mount = ["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", str(out)]
        if os.getuid() != 0 or subprocess.run(mount, capture_output=True).returncode != 0:
            print("no full disk: mounting is not allowed")
            return
        try:
            _, words = self.run(out / "made", 0, status=3)
            self.expect("cannot be written" in words and "MiB are free" in words, words)
            self.expect(len(words.splitlines()) == 1, f"not one line: {words}")
            failed = sorted(p.stem for p in (out / "made/failed").rglob("*.txt"))
            self.expect(set(failed) <= set(BROKEN), f"failed for want of room: {failed}")
            larger = ["mount", "-o", "remount,size=1g", str(out)]
            subprocess.run(larger, check=True)
            self.run(out / "made", 0)
            self.expect_like_one(out / "made", "room")
        finally:
            subprocess.run(["umount", str(out)], check=True)
        print("a full disk: told, and gone on with", flush=True)

    def gone(self):
        away = self.work / "away"
        out = self.work / "gone"
        self.recordings.rename(away)
        _, words = self.run(out, 0, status=3)
        self.expect("check that it is mounted" in words and not out.exists(), words)
        self.recordings.mkdir()
        _, words = self.run(out, 0, status=3)
        self.expect("check that it is mounted" in words and not out.exists(), words)
        self.recordings.rmdir()
        away.rename(self.recordings)
        process = subprocess.Popen(self.command(out, 0), stderr=subprocess.PIPE, text=True)
        while not list(out.glob("recordings/**/frames.csv")):
            time.sleep(0.01)
        self.recordings.rename(away)
        _, words = process.communicate()
        away.rename(self.recordings)
        self.expect(process.returncode == 3 and "check that it is mounted" in words, words)
        self.run(out, 0, "--retry")
        self.expect_like_one(out, "mount")
        shutil.rmtree(out)
        print("recordings that are gone: told, and gone on with", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("press", type=Path)
    parser.add_argument("--mpirun", default="")
    parser.add_argument("--recordings", type=int, default=8)
    parser.add_argument("--kills", type=int, default=1)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        test = Test(arguments, Path(work))
        test.same_bytes()
        few = arguments.kills == 1
        for kind in ("leader",) if few and arguments.mpirun else ("unit", "leader", "all"):
            test.killed_at_random(0, kind, 0.5)
        if arguments.mpirun:
            for kind in ("unit", "rank", "all") if few else ("unit", "leader", "rank", "all"):
                test.killed_at_random(3, kind, 1.5)
        test.gone()
        test.full_disk()
        print("good" if test.failures == 0 else f"{test.failures} failures")
        return 0 if test.failures == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
