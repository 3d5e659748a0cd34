#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""scenes.py CAMERA OUT SCENE ...: what a perfect camera would see of finite-element scenes.

CAMERA is a folder with record.py, which draws scenes. Each scene becomes OUT/NAME with
scene.txt     one "key value" a line: size, optics, pad, rubber, whether the object's face is flat
frames.csv    pressure, force, moment, contact area, stick ratio and pose of the object of each step
depth.f32, contact.u8         of each pixel along its ray, step after step; 0 outside the pad
dots.f64, side_dots.f64       x, y in px of each dot, step after step; NaN where there is none
Step 0 of a scene is the free pad."""
import os
import sys

import numpy as np

camera_tools, out, scenes = sys.argv[1], sys.argv[2], sys.argv[3:]
sys.path.insert(0, camera_tools)
import record  # noqa: E402

curved = ("roll", "cylinder", "ball_slip", "rod_turn", "bowl", "two_balls")


def stick_ratios(scene):
    """By area in contact, of what slips less than 5 um in a step. A layer of foam touches more
    nodes than it carries, so its own path counts."""
    ratios = scene.steps["stick_ratio_kin"].copy()
    if "foam" in scene.folder:
        path = np.asarray(scene.slip_path, float)
        for k in range(1, len(path)):
            on = scene.contact_flag[k] > 0
            area = np.asarray(scene.contact_area[k], float)[on]
            if area.sum() > 0:
                ratios[k] = area[(path[k] - path[k - 1])[on] < 0.005].sum() / area.sum()
    return ratios


for folder in scenes:
    scene = record.Scene(folder)
    name = os.path.basename(folder.rstrip("/"))
    to = os.path.join(out, name)
    if os.path.exists(os.path.join(to, "scene.txt")):
        continue
    os.makedirs(to, exist_ok=True)
    pad = record.Pad(scene, [0.8], 72)
    c = record.for_pad(record.settings("studio", []), pad)
    steps = list(range(len(scene.steps["p"])))
    size, apex = 2 * pad.dot_half + 1, None
    with (open(to + "/depth.f32", "wb") as depths, open(to + "/contact.u8", "wb") as contacts,
          open(to + "/dots.f64", "wb") as dots, open(to + "/side_dots.f64", "wb") as sides):
        for depth, contact, _, _, n, x in record.look(pad, steps, c, record.tool()):
            np.nan_to_num(depth).astype("<f4").tofile(depths)
            (contact & np.isfinite(depth)).astype("u1").tofile(contacts)
            grid = np.full((size, size, 2), np.nan)
            at = record.pixel_of_points(record.surface_point(x, n, *pad.dots_at), c)
            grid[pad.dots_id[:, 1] + pad.dot_half, pad.dots_id[:, 0] + pad.dot_half] = at
            grid.tofile(dots)
            record.pixel_of_points(record.surface_point(x, n, *pad.side_at), c).tofile(sides)
            apex = np.nanmax(depth) if apex is None else apex
    columns = [scene.steps["p"], scene.F, scene.M, scene.steps["contact_area"],
               stick_ratios(scene),
               np.stack([scene.steps["obj_" + q] for q in ("x", "y", "z", "rx", "ry", "rz")], -1)]
    np.savetxt(to + "/frames.csv", np.column_stack(columns), delimiter=",", fmt="%.8g", comments="",
               header="p,fx,fy,fz,mx,my,mz,area,stick,x,y,z,rx,ry,rz")
    m = scene.meta
    values = dict(rows=c["rows"], cols=c["cols"], steps=len(steps), dots=size, side_dots=72,
                  pitch_mm=c["pitch"], distance_mm=c["distance"], index=c["index"],
                  center_x_px=c["center_x"], center_y_px=c["center_y"], base_mm=pad.base,
                  apex_mm=apex, mould_mm=pad.H, mooney_share=m.get("mooney_share", 0.0),
                  modulus_n_per_mm=m["shear_modulus_MPa"] * m["thickness_mm"],
                  dot_mm=pad.dot_d, flat=int(not any(q in name for q in curved)))
    with open(to + "/scene.txt", "w") as f:
        f.writelines("%s %.9g\n" % pair for pair in values.items())
    print(name, len(steps), flush=True)
