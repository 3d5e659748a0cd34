#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""live.py REPLAY RECORDING: replays a recorded video instead of a camera in a window on a separate
screen (Xvfb). Below the title, the window must show what --headless writes; the key r records."""
import ctypes
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    import numpy as np
    from PIL import Image
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)
if not shutil.which("Xvfb"):
    print("skipped: there is no Xvfb to show a window on")
    sys.exit(77)

TITLE = 80  # rows of an image: latency, number of the frame
CURSOR = 400  # pixels


def screen_of(file):
    """RGB of a screen that Xvfb keeps in a file in the format of xwd; None if incomplete."""
    data = file.read_bytes()
    head = np.frombuffer(data[:100], ">u4")
    if len(head) < 25 or len(data) < head[0] + 12 * head[19] + head[5] * head[12]:
        return None
    rows, cols, row_bytes = int(head[5]), int(head[4]), int(head[12])
    pixels = np.frombuffer(data, np.uint8, rows * row_bytes, int(head[0] + 12 * head[19]))
    return pixels.reshape(rows, row_bytes // 4, 4)[:, :cols, 2::-1]


def differing(picture, screen):
    rows, cols = picture.shape[:2]
    return (picture[TITLE:] != screen[TITLE:rows, :cols]).any(axis=2).sum()


def press(key, display):
    """Presses and releases a key on the window under the pointer, the middle of the screen."""
    x11, test = ctypes.CDLL("libX11.so.6"), ctypes.CDLL("libXtst.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    screen = ctypes.c_void_p(x11.XOpenDisplay(display.encode()))
    code = x11.XKeysymToKeycode(screen, ctypes.c_ulong(ord(key)))
    for down in (1, 0):
        test.XTestFakeKeyEvent(screen, code, down, 0)
    x11.XSync(screen, 0)
    x11.XCloseDisplay(screen)


def run(replay, recording, work):
    video = work / "video.pngs"  # a sequence of images: lossless
    frames = [f.read_bytes() for f in sorted((recording / "frames").iterdir())]
    video.write_bytes(b"".join(frames * 8))
    command = [replay, recording, "--video", video]

    no_screen = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    refused = subprocess.run(command, env=no_screen, capture_output=True, text=True)
    assert refused.returncode == 1 and "there is no screen" in refused.stderr, refused

    out = work / "out"
    once = ["--frames", f":{len(frames)}", "--headless", "--out", out, "--record", work / "taken"]
    subprocess.run(command + once, check=True)
    written = [np.array(Image.open(f)) for f in sorted((out / "pictures").iterdir())]
    assert len(written) == len(frames)
    assert len((out / "frames.csv").read_text().splitlines()) == len(frames) + 1

    # What was recorded holds the frames as they came, and replay reads it.
    taken = sorted((work / "taken" / "001" / "frames").iterdir())
    assert [p.name for p in (work / "taken").iterdir()] == ["001"] and len(taken) == len(frames)
    for got, given in zip(taken, sorted((recording / "frames").iterdir())):
        assert (np.array(Image.open(got)) == np.array(Image.open(given))).all(), got
    subprocess.run([replay, taken[0].parent.parent, "--sensor", recording / "sensor.json", "--no-pictures",
                    "--out", work / "again"], check=True, stdout=subprocess.DEVNULL)
    assert len((work / "again" / "frames.csv").read_text().splitlines()) == len(frames) + 1

    ready, told = os.pipe()
    xvfb = subprocess.Popen(
        ["Xvfb", "-displayfd", str(told), "-screen", "0", "1024x1280x24", "-nolisten", "tcp",
         "-fbdir", work], pass_fds=[told], stderr=subprocess.DEVNULL)
    try:
        os.close(told)
        display = ":" + os.read(ready, 16).decode().strip()
        keyed = [*command, "--record", work / "keyed"]
        shown = subprocess.Popen(keyed, env={**no_screen, "DISPLAY": display},
                                 stdout=subprocess.PIPE, text=True)
        seen, best = 0, written[0].size
        while shown.poll() is None:
            screen = screen_of(work / "Xvfb_screen0")
            if screen is not None and np.count_nonzero(screen) > written[0].size // 2:
                if seen == 0:
                    press("r", display)
                seen += 1
                best = min(best, *(differing(picture, screen) for picture in written))
            time.sleep(0.02)
        said = shown.stdout.read()
        print(said, f"{seen} looks, {best} pixels differ", sep="")
        assert shown.returncode == 0
        assert seen > 0 and best < CURSOR
        recorded = list((work / "keyed" / "001" / "frames").iterdir())
        assert recorded and f"{work / 'keyed' / '001'}, {len(recorded)} frames" in said
        assert re.search(r"shown +\d+ of \d+ frames\nrate +[\d.]+ pictures per second.*\n"
                         r"latency +[\d.]+ ms from frame to picture", said), said
    finally:
        xvfb.terminate()
        xvfb.wait()


with tempfile.TemporaryDirectory() as folder:
    run(Path(sys.argv[1]).resolve(), Path(sys.argv[2]), Path(folder))
