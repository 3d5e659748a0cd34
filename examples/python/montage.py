#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Camera image with the contact outlined, depth, and what is pressed in: montage.py RECORDING OUT.png"""
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

import fingerpad as fp

recording, out = map(Path, sys.argv[1:])
pad = np.array(Image.open(recording / "reference.png")) + np.float32(0.5)  # Pillow cuts 16 bit off
shape = np.array(Image.open(recording / "reference_depth.tiff"))
rows, cols = shape.shape
camera = fp.Camera(center_x_px=(cols - 1) / 2, center_y_px=(rows - 1) / 2)
fluid = fp.Absorption()
reference = fp.fit_reference(camera, fluid, pad[..., 0], pad[..., 1], shape)
estimate = fp.DepthEstimator(camera, fluid, reference)
region = fp.ContactRegion(camera, rows, cols, fp.ContactTest(free_apex_mm=np.nanmax(shape)))

frames = sorted((recording / "frames").glob("*.png"))[::2]
figure, axes = plt.subplots(3, len(frames), figsize=(2 * len(frames), 6), layout="constrained")
for column, name in zip(axes.T, frames):
    frame = np.array(Image.open(name))
    depth, status, _ = estimate(frame[..., 0], frame[..., 1])
    mask, contact = region(depth)
    print(f"{name.stem}: {contact.area_mm2:.0f} mm^2 in contact")
    column[0].imshow(np.clip(frame * 4.0 / 255, 0, 1))
    if contact.in_contact:
        column[0].contour(mask, levels=[127], colors="white", linewidths=1)
    column[0].set_title(f"{name.stem}: {contact.area_mm2:.0f} mm$^2$", fontsize=8)
    depths = column[1].imshow(depth, vmin=0, vmax=fluid.max_depth_mm)
    pressed = column[2].imshow(shape - depth, vmin=-3, vmax=3, cmap="RdBu_r")
    for axis in column:
        axis.set_axis_off()
figure.colorbar(depths, ax=axes[1], label="depth, mm")
figure.colorbar(pressed, ax=axes[2], label="pressed in, mm")
figure.suptitle("White: where the object touches; below: depth; red: pressed in, blue: bulging out")
figure.savefig(out, dpi=80)
