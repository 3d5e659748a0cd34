#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""judge.py CONDITION RECORDING REPLAYED SCENE: how far the results of `replay --raw` are off.

RECORDING has the truth beside it in truth/, REPLAYED is what replay wrote, SCENE is the folder of
the finite elements. Prints the lines of `trust`: condition,scene,frame,quantity,error,limit,sd,
confident."""
import csv
import glob
import json
import math
import os
import sys

import cv2
import numpy as np

LINES = csv.writer(sys.stdout, lineterminator="\n")
CURVED = ("roll", "cylinder", "ball_slip", "rod_turn", "bowl", "two_balls")


def table(file):
    with open(file, newline="", encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def number(row, name):
    return float(row[name]) if row.get(name) else math.nan


def rotation(x, y, z):
    """About x, then y, then z."""
    a, b, c = ([math.cos(q), math.sin(q)] for q in (x, y, z))
    about_x = np.array([[1, 0, 0], [0, a[0], -a[1]], [0, a[1], a[0]]])
    about_y = np.array([[b[0], 0, b[1]], [0, 1, 0], [-b[1], 0, b[0]]])
    about_z = np.array([[c[0], -c[1], 0], [c[1], c[0], 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


class Judge:
    def __init__(self, condition, recording, replayed, scene):
        self.condition, self.replayed = condition, replayed
        self.truth = recording + "/truth"
        self.name = os.path.basename(scene.rstrip("/"))
        with open(self.truth + "/what.json", encoding="utf-8") as file:
            self.what = json.load(file)
        self.forces = table(self.truth + "/forces.csv")
        self.steps = table(scene + "/steps.csv")
        with open(scene + "/meta.json", encoding="utf-8") as file:
            self.base = json.load(file)["base_radius_mm"]
        self.loads = np.array([[number(r, k) for k in ("fx_n", "fy_n", "fz_n", "mx_nmm", "my_nmm",
                                                       "mz_nmm", "contact_area_mm2")]
                               for r in self.forces])
        # full scale is the whole scene's, whichever of its steps were recorded
        f = np.array([[number(r, k) for k in ("Fx", "Fy", "Fz", "Mx", "My", "Mz", "contact_area")]
                      for r in self.steps])
        press, radius = np.abs(f[:, 2]).max(), math.sqrt(f[:, 6].max() / math.pi)
        self.full = (max(np.hypot(f[:, 0], f[:, 1]).max(), 0.5 * press), press,
                     max(np.hypot(f[:, 3], f[:, 4]).max(), 0.9 * press * radius),
                     max(np.abs(f[:, 5]).max(), 0.3 * press * radius))
        self.begun = None

    def say(self, frame, quantity, error, limit, sd, sure):
        if error == error:
            LINES.writerow([self.condition, self.name, frame, quantity, "%.5g" % error,
                            "%g" % limit, "%.5g" % sd, int(sure)])

    def depth(self, k, row):
        camera = self.what["camera"]
        true = np.load("%s/depth_%06d.npy" % (self.truth, k))
        found = cv2.imread("%s/depth/%06d.tiff" % (self.replayed, k), cv2.IMREAD_UNCHANGED)
        y, x = np.indices(true.shape)
        away = np.hypot((x - camera["center_x"]) * camera["pitch"],
                        (y - camera["center_y"]) * camera["pitch"] * camera["pitch_ratio"])
        error = np.abs(found - true)[away < 0.75 * self.base]
        if np.isfinite(error).any():
            self.say(k, "depth", np.nanmean(error), 0.09, math.nan, row["depth_status"] == "ok")

    def contact(self, k, row):
        true = np.load("%s/contact_%06d.npy" % (self.truth, k))
        found = cv2.imread("%s/contact/%06d.png" % (self.replayed, k), cv2.IMREAD_UNCHANGED) > 0
        both, either = (true & found).sum(), (true | found).sum()
        sure = row["contact_status"] == "ok"
        self.say(k, "contact", 1 - both / either if either else 0,
                 0.48 if any(q in self.name for q in CURVED) else 0.32, math.nan, sure)
        if both:
            self.say(k, "area", abs(number(row, "contact_area_mm2") - self.loads[k, 6]), 1e9,
                     number(row, "contact_area_sd_mm2"), sure)

    def motion(self, k, row):
        step = self.steps[self.what["steps"][k]]
        place = np.array([number(row, "object_%s_mm" % q) for q in "xyz"])
        turned = rotation(*(number(row, "rotation_%s_rad" % q) for q in "xyz"))
        if not np.isfinite(place).all():
            return
        now = rotation(*(number(step, "obj_r" + q) for q in "xyz"))
        at = np.array([number(step, "obj_" + q) for q in "xyz"])
        if self.begun is None or self.begun[0] != row["object"]:
            self.begun = (row["object"], now, at, place)  # its pose is the identity in this frame
            return
        _, first, first_at, first_place = self.begun
        moved = now @ first.T
        cosine = (np.trace(turned.T @ moved) - 1) / 2
        sure = row["motion_status"] == "ok"
        degrees = 180 / math.pi
        self.say(k, "rotation", degrees * math.acos(min(1, max(-1, cosine))), 3.2,
                 degrees * number(row, "rotation_sd_rad"), sure)
        true_place = moved @ (first_place - first_at) + at
        self.say(k, "place", np.linalg.norm(place - true_place), 0.072,
                 number(row, "object_sd_mm"), sure)

    def forces_of(self, k, row):
        true = self.loads[k]
        found = [number(row, "wrench_f%s_n" % q) for q in "xyz"]
        found += [1000 * number(row, "wrench_m%s_nm" % q) for q in "xyz"]
        sd = [number(row, "wrench_f%s_sd_n" % q) for q in "xyz"]
        sd += [1000 * number(row, "wrench_m%s_sd_nm" % q) for q in "xyz"]
        parts = (("F_xy", (0, 1), 0.03), ("F_z", (2,), 0.096), ("M_xy", (3, 4), 0.09),
                 ("M_z", (5,), 0.057))
        for full, (name, of, limit) in zip(self.full, parts):
            error = math.sqrt(sum((found[q] - true[q]) ** 2 for q in of))
            self.say(k, name, error / full, limit, math.sqrt(sum(sd[q] ** 2 for q in of)) / full,
                     row["wrench_status"] == "ok")

    def run(self):
        for row in table(self.replayed + "/frames.csv"):
            k = int(row["frame"])
            if glob.glob("%s/depth/%06d.tiff" % (self.replayed, k)):
                self.depth(k, row)
                self.contact(k, row)
            self.motion(k, row)
            if self.loads[k, 6] > 0:
                self.say(k, "stick ratio",
                         abs(number(row, "stick_ratio") - number(self.forces[k], "stick_ratio")),
                         0.3, number(row, "stick_ratio_sd"), row["slip_status"] == "ok")
            self.forces_of(k, row)


if __name__ == "__main__":
    Judge(*sys.argv[1:5]).run()
