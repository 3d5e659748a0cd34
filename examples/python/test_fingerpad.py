# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Tests the Python module on the bundled recording: pytest test_fingerpad.py, with the module's folder
in PYTHONPATH. FINGERPAD_PROGRAMS is the folder of replay and calibrate, whose results must be equal."""
import ast
import base64
import csv
import hashlib
import json
import inspect
import os
import pydoc
import re
import shutil
import subprocess
import sys
import threading
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import fingerpad as fp

DATA = Path(__file__).parents[1] / "data"
PRESS = DATA / "press"
NO_DOTS_MM, NO_DOTS_PX = np.zeros((0, 0, 3)), np.zeros((0, 0, 2))


def picture(name):
    return np.array(Image.open(PRESS / name))


def table(file):
    """Columns of numbers of a file by name; NaN for an empty cell."""
    with open(file, newline="") as lines:
        rows = list(csv.DictReader(lines))
    number = lambda cell: float(cell) if cell else np.nan
    return {name: np.array([number(row[name]) for row in rows]) for name in rows[0]
            if name not in ("load", "slip_evidence") and not name.endswith("status")}


def run(program, *arguments):
    folder = os.environ.get("FINGERPAD_PROGRAMS")
    if not folder:
        pytest.skip("FINGERPAD_PROGRAMS does not name the folder of the C++ programs")
    subprocess.run([Path(folder) / program, *arguments], check=True, stdout=subprocess.DEVNULL)


def channels(rgb):
    return rgb[:, :, 0], rgb[:, :, 1]


@pytest.fixture(scope="module")
def pad():
    camera = fp.Camera(center_x_px=239.5, center_y_px=239.5)
    fluid = fp.Absorption()
    shape = picture("reference_depth.tiff")
    reference = fp.fit_reference(camera, fluid, *channels(picture("reference.png")), shape)
    return camera, fluid, reference


@pytest.fixture(scope="module")
def estimate(pad):
    return fp.DepthEstimator(*pad)


def test_depth_and_contact_of_the_recording(pad, estimate):
    depth, status, result = estimate(*channels(picture("frames/000005.png")))
    assert depth.dtype == np.float32 and result.ok
    assert (np.isnan(depth) == (status != int(fp.PixelStatus.ok))).all()
    region = fp.ContactRegion(pad[0], *depth.shape, fp.ContactTest(free_apex_mm=13.03))
    mask, contact = region(depth)
    assert contact.in_contact and contact.contact_px == (mask == 255).sum()
    assert abs(contact.area_mm2 - 100) < 20


@pytest.mark.parametrize("kind", [np.uint16, np.float32, np.float64])
def test_wider_pixels_of_the_same_values_give_the_same_depth(pad, estimate, kind):
    frame = picture("frames/000005.png")
    depth, _, _ = estimate(*channels(frame))
    wide, status, result = estimate(*channels(frame.astype(kind)))
    if kind == np.uint16:  # the full scale of 16 bit is larger, so these are dark
        assert not result.ok
    else:
        ok = status == int(fp.PixelStatus.ok)
        assert ok.sum() > 100_000 and np.abs(wide - depth)[ok].max() < 1e-3


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float32, np.float64])
def test_strides_do_not_matter(pad, estimate, kind):
    red, green = (c.astype(kind) for c in channels(picture("frames/000005.png")))
    expected, _, _ = estimate(red, green)
    among_others = np.zeros((480, 2 * 480, 3), kind)
    among_others[:, ::2, 1] = red
    upside_down = np.ascontiguousarray(green[::-1, ::-1])
    for r, g in [(among_others[:, ::2, 1], upside_down[::-1, ::-1]),
                 (np.asfortranarray(red), np.ascontiguousarray(green.T).T)]:
        assert not r.flags["C_CONTIGUOUS"] and not g.flags["C_CONTIGUOUS"]
        depth, _, _ = estimate(r, g)
        np.testing.assert_array_equal(expected, depth)


def test_arrays_are_read_where_they_lie(estimate):
    # The memory of a single row serves as 2^24 rows; a copy would need 16 TiB.
    with pytest.raises(ValueError, match="480 x 480"):
        row = np.zeros(1 << 20, np.uint8)
        rows = np.lib.stride_tricks.as_strided(row, (1 << 24, 1 << 20), (0, 1))
        estimate(rows, rows)
    red, green = channels(picture("frames/000005.png"))
    red.flags.writeable = False
    estimate(red, green)


def test_results_are_written_to_arrays_that_are_given(pad, estimate):
    red, green = channels(picture("frames/000005.png"))
    expected, status, _ = estimate(red, green)
    among_others, flags = np.zeros((480, 480, 2), np.float32), np.zeros((480, 480), np.uint8)
    depth, _, _ = estimate(red, green, out=(among_others[..., 1], flags))
    assert np.shares_memory(depth, among_others)
    np.testing.assert_array_equal(among_others[..., 1], expected)
    np.testing.assert_array_equal(flags, status)
    region = fp.ContactRegion(pad[0], 480, 480)
    assert region(expected, out=flags)[0] is flags
    np.testing.assert_array_equal(flags, region(expected)[0])
    with pytest.raises(ValueError, match=r"out must have the shape \(480, 480\)"):
        region(expected, out=flags[1:])
    flags.flags.writeable = False
    with pytest.raises(ValueError, match="not writeable"):
        region(expected, out=flags)


def wrench_of_dots(camera):
    """A wrench that has learnt a grid of dots of the free pad, and the grid."""
    y, x = np.mgrid[:21, :21] * 22.0 + 20
    wrench, free_px = fp.Wrench(camera), np.stack([x, y], axis=-1)
    assert wrench.learn(free_px, 0.016) > 100
    return wrench, free_px


def test_what_is_slow_runs_without_the_lock(pad, estimate):
    red, green = channels(picture("frames/000005.png"))
    depth, _, _ = estimate(red, green)
    region = fp.ContactRegion(pad[0], 480, 480)
    wrench, free_px = wrench_of_dots(pad[0])
    fingertip = fp.Fingertip(*pad, NO_DOTS_MM)
    calls = [lambda: estimate(red, green), lambda: region(depth),
             lambda: wrench(free_px, 0.016), lambda: fingertip(red, green, NO_DOTS_PX, 0.0165)]
    usual = sys.getswitchinterval()
    for call in calls:
        go, others = threading.Lock(), []
        go.acquire()
        other = threading.Thread(target=lambda: go.acquire() and others.append(1))
        other.start()
        sys.setswitchinterval(1000)  # from here on the GIL is released only explicitly
        try:
            go.release()
            for _ in range(1000):
                if others:
                    break
                call()
            assert others
        finally:
            sys.setswitchinterval(usual)
            other.join()


def test_threads_give_the_same_bits(estimate):
    red, green = channels(picture("frames/000005.png"))
    expected, _, _ = estimate(red, green)
    with ThreadPoolExecutor(4) as pool:
        for depth, _, _ in pool.map(lambda _: estimate(red, green), range(8)):
            np.testing.assert_array_equal(expected, depth)


def test_a_mistake_is_an_exception_with_its_reason(pad, estimate):
    red, green = channels(picture("frames/000005.png"))
    with pytest.raises(fp.ParameterError, match="pitch_mm"):
        fp.ContactRegion(fp.Camera(pitch_mm=-1), 10, 10)
    with pytest.raises(TypeError, match="no pitch; it is Camera.plate_distance_mm=50.0, .*pitch_mm="):
        fp.Camera(pitch=0.1)
    with pytest.raises(ValueError, match="480 x 480"):
        estimate(red[1:], green[1:])
    with pytest.raises(TypeError, match="uint8"):
        estimate(red, green.astype(np.float32))
    with pytest.raises(TypeError, match=r"\(rows, cols\)"):
        estimate(picture("frames/000005.png"), green)
    with pytest.raises(TypeError, match="not aligned in memory"):
        estimate(np.zeros((480, 480, 3), "u1, u2")["f1"][..., 0], green.astype(np.uint16))
    with pytest.raises(ValueError, match=r"^Camera: pitch_mm = -1, must be finite and > 0$"):
        fp.Wrench(fp.Camera(pitch_mm=-1))
    with pytest.raises(fp.ParameterError, match="slip_share = 0"):
        fp.StickRatio(9, 9, fp.StickOptions(slip_share=0))
    with pytest.raises(ValueError, match="9 x 9"):
        fp.StickRatio(9, 9)(np.zeros((8, 9, 2)), np.ones((8, 9), bool))
    with pytest.raises(fp.ParameterError, match="usable samples"):
        fp.fit_normal_force([], [])
    with pytest.raises(ValueError, match=r"normal_force_n must have the shape \(2,\), not \(3,\)"):
        fp.fit_normal_force([1, 2], [1, 2, 3])
    with pytest.raises(TypeError, match="int32"):
        estimate(red.astype(np.int32), green.astype(np.int32))


@pytest.mark.parametrize("said, call", [
    ("dots is a masked array", lambda ratio, d: ratio(np.ma.masked_less(d, 1), d[..., 0] > 0)),
    ("in_contact is a masked", lambda ratio, d: ratio(d, np.ma.masked_less(d[..., 0], 1) > 0)),
    ("dots must be a NumPy array, not list: convert it with np.asarray", lambda ratio, d: ratio(d.tolist(), d)),
    ("dots must be a NumPy array, not NoneType", lambda ratio, d: ratio(None, d)),
    ("time_s must be a real number, not str", lambda ratio, d: ratio(d, d[..., 0] > 0, "1")),
    ("time_s must be a real number, not bool", lambda ratio, d: ratio(d, d[..., 0] > 0, True)),
    ("measure must contain real numbers, .* not complex128",
     lambda ratio, d: fp.fit_normal_force(np.arange(1, 9) + 1j, np.arange(8))),
    ("measure is a masked array",
     lambda ratio, d: fp.fit_normal_force(np.ma.masked_less(np.arange(9.0), 3), np.arange(9))),
    ("normal_force_n must contain real", lambda ratio, d: fp.fit_normal_force([1, 2], ["1", "2"])),
    ("rows must be an int, not bool", lambda ratio, d: fp.StickRatio(True, 9)),
    ("cols must be an int, not float", lambda ratio, d: fp.FoamHand(4, 4.0)),
    ("StickOptions: noise must be a real number, not bool",
     lambda ratio, d: fp.StickOptions(noise=True)),
    ("Camera: pitch_mm must be a real number, not complex128",
     lambda ratio, d: fp.Camera(pitch_mm=np.complex128(0.1 + 1j))),
    ("StickOptions: covers_pattern must be True or False, not str",
     lambda ratio, d: fp.StickOptions(covers_pattern="no")),
    ("readings must be the arrays of two fingers", lambda ratio, d: fp.FoamHand(4, 4)(None, 0.0)),
    ("depth_mm must be a NumPy array",
     lambda ratio, d: fp.ContactRegion(fp.Camera(), 9, 9)([[1.0]])),
])
def test_what_is_no_array_or_number_is_refused_by_name(said, call):
    y, x = np.mgrid[:9, :9] * 20.0
    with pytest.raises(TypeError, match=f"^{said}"):
        call(fp.StickRatio(9, 9), np.stack([x, y], axis=-1))


def test_where_nothing_is_known_nothing_is_free(pad):
    nothing = np.full((480, 480), np.nan, np.float32)
    mask, contact = fp.ContactRegion(pad[0], 480, 480)(nothing)
    assert not contact.ok and contact.status == "not of this pad"
    felt = fp.Wrench(pad[0])(np.full((21, 21, 2), np.nan), 0.0165)
    assert not felt.ok and felt.status == "too few marks" and np.isnan(felt.force_n).all()


def test_a_foam_hand_warns_of_vibration_that_moves_and_quickens():
    hand = fp.FoamHand(4, 4, fp.TaxelOptions(noise=1, sample_period_s=0.01))
    rng = np.random.default_rng(1)
    statuses = []
    for k in range(120):
        readings = [np.full((4, 4), 50.0) + rng.normal(0, 0.5, (4, 4)) for _ in range(2)]
        if k > 60:  # the load moves, and another taxel vibrates
            readings[0][1, 2] += 20 * (-1) ** k
            readings[0][3, 3] += 200
        felt = hand(readings, 0.01 * k)
        statuses.append(felt.status)
    assert fp.PreslipStatus.preslip not in statuses[:60]
    assert fp.PreslipStatus.preslip in statuses[60:]
    hand.reset()
    assert hand(readings, 0.0).status == fp.PreslipStatus.cannot_tell


def test_all_that_can_be_called_says_what_it_takes():
    shapes = {fp.DepthEstimator: "(rows, cols)", fp.ContactRegion: "(rows, cols)",
              fp.StickRatio: "(rows, cols, 2)", fp.Wrench: "(rows, cols, 2)",
              fp.Fingertip: "(rows, cols, 2)", fp.FoamHand: "(rows, cols)",
              fp.NormalForce: "mm^2 or mm", fp.Shear: "measure"}
    for kind, shape in shapes.items():
        assert kind.__doc__ and shape in kind.__call__.__doc__, kind
    for function in (fp.fit_reference, fp.fit_normal_force, fp.fit_tangential_force, fp.fit_moment):
        assert "measure: (n,)" in function.__doc__ or "(rows, cols)" in function.__doc__ or \
            "All (n,)" in function.__doc__, function
    pages = [page for thing in vars(fp).values() for page in re.findall(r"docs/[\w/]+\.md", thing.__doc__ or "")]
    assert len(pages) >= 20 and all((DATA.parents[1] / page).exists() for page in pages), pages


def test_statuses_are_those_of_cpp():
    names = {fp.PixelStatus: 7, fp.PreslipStatus: 4, fp.DotState: 4}
    for kind, count in names.items():
        assert sorted(int(value) for value in kind.__members__.values()) == list(range(count))


def test_dots_that_move_as_one_stick_and_those_that_stay_behind_slip():
    y, x = np.mgrid[:9, :9] * 20.0
    free = np.stack([x, y], axis=-1)
    ratio = fp.StickRatio(9, 9, fp.StickOptions(noise=0.06))
    inside = np.hypot(x - 80, y - 80) < 70
    for k in range(12):
        dots = free + [1.2 * k, 0]
        dots[inside & (x > 110)] -= [0.6 * k, 0]
        states, result = ratio(dots, inside, 0.02 * k)
    assert result.ok and result.status == "updated"
    slipping = inside & (x > 110)
    assert (states[slipping] == int(fp.DotState.slip)).all()
    assert (states[inside & ~slipping] == int(fp.DotState.stick)).all()
    assert result.stick_ratio == pytest.approx((inside & ~slipping).sum() / inside.sum())
    assert ratio(dots.transpose(1, 0, 2).copy().transpose(1, 0, 2), inside.view(np.uint8))[1].ok
    ratio.reset()
    assert np.isnan(ratio(free, inside)[1].stick_ratio)


def test_frames_have_the_bits_of_cpp(tmp_path):
    recording = tmp_path / "press"
    shutil.copytree(PRESS, recording)
    # The reference has 16 bit, of which Pillow reads 8; the file is replaced by what Pillow reads.
    Image.fromarray(picture("reference.png")).save(recording / "reference.png")
    sensor = json.loads((recording / "sensor.json").read_text())
    sensor["contact"] = {"threshold_per_mm": 0.025}
    (recording / "sensor.json").write_text(json.dumps(sensor))
    run("replay", recording, "--out", tmp_path / "out", "--raw", "--no-pictures")
    frames, signals = table(tmp_path / "out/frames.csv"), table(recording / "signals.csv")
    given = {k: v for k, v in sensor["camera"].items() if k != "center_px"}
    camera = fp.Camera(center_x_px=239.5, center_y_px=239.5, **given)
    fluid = fp.Absorption(**sensor["absorption"])
    reference = fp.fit_reference(camera, fluid, *channels(picture("reference.png")),
                                 picture("reference_depth.tiff"))
    pad, estimate = (camera, fluid, reference), fp.DepthEstimator(camera, fluid, reference)
    test = fp.ContactTest(threshold_per_mm=0.025, free_apex_mm=13.03)
    region = fp.ContactRegion(pad[0], 480, 480, test)
    dots_px = np.full((11, 21, 21, 2), np.nan)
    found = table(tmp_path / "out/dots.csv")
    index = [found[name].astype(int) for name in ("frame", "row", "col")]
    dots_px[tuple(index)] = np.stack([found["x_px"], found["y_px"]], axis=-1)
    touched = np.zeros((11, 21, 21), bool)
    touched[tuple(index)] = found["contact"] > 0
    wrench = fp.Wrench(camera, fp.WrenchOptions(
        stress_free_height_mm=18.735 * np.tan(1.0618 / 2), base_radius_mm=18.735,
        modulus_n_per_mm=0.5))
    assert wrench.learn(dots_px[0], 0.016) > 100
    fingertip = fp.Fingertip(*pad, NO_DOTS_MM, test)
    for k, pressure_mpa in enumerate(signals["pressure_mpa"]):
        red, green = channels(picture(f"frames/{k:06}.png"))
        depth, _, _ = estimate(red, green)
        mask, contact = region(depth)
        # of a learnt place with the noise of one picture
        felt = wrench(np.where(touched[k, ..., None], np.nan, dots_px[k]), pressure_mpa,
                      0.06 * 2 ** 0.5)
        np.testing.assert_array_equal(depth, Image.open(tmp_path / f"out/depth/{k:06}.tiff"))
        np.testing.assert_array_equal(mask, Image.open(tmp_path / f"out/contact/{k:06}.png"))
        assert f"{contact.area_mm2:.6f}" == f"{frames['contact_area_mm2'][k]:.6f}"
        for axis, n, n_mm in zip("xyz", felt.force_n, felt.moment_n_mm):
            assert abs(n - frames[f"wrench_f{axis}_n"][k]) < 1e-3
            assert abs(n_mm / 1000 - frames[f"wrench_m{axis}_nm"][k]) < 1e-4
        fingertip(red, green, NO_DOTS_PX, pressure_mpa)
        np.testing.assert_array_equal(fingertip.depth_mm, depth)


def test_the_stick_ratio_has_the_bits_of_cpp(tmp_path):
    recording = tmp_path / "dots"
    shutil.copytree(PRESS / "frames", recording / "frames")
    (recording / "sensor.json").write_text('{"stick": {"covers_pattern": true}}')
    y, x = np.mgrid[:12, :12] * 20.0 + 120
    rng = np.random.default_rng(1)
    frames = []
    for k in range(11):
        dots = np.stack([x + 0.7 * k, y], axis=-1) + rng.normal(0, 0.06, (12, 12, 2))
        dots[:, 9:] -= [0.4 * k, 0]
        frames.append(dots.round(6))
    with open(recording / "dots.csv", "w") as file:
        file.write("frame,row,col,x_px,y_px\n")
        for k, dots in enumerate(frames):
            for i, j in np.ndindex(12, 12):
                file.write(f"{k},{i},{j},{dots[i, j, 0]:.6f},{dots[i, j, 1]:.6f}\n")
    run("replay", recording, "--out", tmp_path / "out", "--no-pictures")
    told, of_dots = table(tmp_path / "out/frames.csv"), table(tmp_path / "out/dots.csv")
    ratio = fp.StickRatio(12, 12, fp.StickOptions(covers_pattern=True))
    for k, dots in enumerate(frames):
        states, result = ratio(dots, np.ones((12, 12), bool))
        assert f"{result.stick_ratio:.6f}" == f"{told['stick_ratio'][k]:.6f}"
        sticks = of_dots["stick"][of_dots["frame"] == k].reshape(12, 12)
        np.testing.assert_array_equal(states == int(fp.DotState.stick), sticks == 1)
        np.testing.assert_array_equal(states == int(fp.DotState.slip), sticks == 0)
    assert 0 < result.stick_ratio < 1


def test_fits_have_the_bits_of_cpp_and_are_looked_up(pad, tmp_path):
    contacts = table(DATA / "contacts.csv")
    shift = np.stack([contacts["shift_x_mm"], contacts["shift_y_mm"]], axis=-1)
    along = np.stack([contacts["force_x_n"], contacts["force_y_n"]], axis=-1)
    (tmp_path / "sensor.json").write_text("{}")
    shutil.copy(DATA / "contacts.csv", tmp_path)
    run("calibrate", "force", tmp_path, "--contacts", "contacts.csv")
    force = json.loads((tmp_path / "sensor.json").read_text())["force"]
    for name, unit, column, reference in [("area", "mm2", "flat_area_mm2", 100),
                                          ("depth", "mm", "contact_depth_mm", 2)]:
        measure = contacts[column]
        normal = fp.fit_normal_force(measure, -contacts["force_z_n"], degree=3)
        expected = force[f"by_{name}"]
        assert normal.ok, normal.status
        assert normal.coefficients == expected["coefficients"]
        assert normal.range == [expected[f"from_{unit}"], expected[f"to_{unit}"]]
        assert normal.residual_sd_n == expected["residual_n"]
        tangential = fp.fit_tangential_force(measure, shift, along, reference)
        moment = fp.fit_moment(measure, contacts["shift_rad"], 1000 * contacts["moment_z_nm"],
                               reference)
        if force["shear"]["by"] == name:
            assert [tangential.stiffness] == force["shear"]["force_n_per_mm"]
            assert tangential.exponent == force["shear"]["displacement_exponent"]
            assert [moment.stiffness] == force["shear"]["moment_n_mm_per_rad"]
            assert (tangential.to, moment.to) == (force["shear"]["to_mm"], force["shear"]["to_rad"])

    by_depth, shear = fp.NormalForce(normal), fp.Shear(tangential, moment)
    felt = by_depth(2.0)
    assert felt.ok and felt.force_n == pytest.approx(np.polyval(normal.coefficients[::-1], 2.0))
    assert by_depth(100.0).status == "beyond range"
    along_x, _ = shear(2.0, (0.5, 0), 0.01).tangential_force_n
    assert along_x == pytest.approx(0.5 * tangential.stiffness)
    fingertip = fp.Fingertip(*pad, NO_DOTS_MM, fp.ContactTest(free_apex_mm=13.03),
                             force_of_depth=by_depth)
    touch = fingertip(*channels(picture("frames/000005.png")), NO_DOTS_PX, np.nan)
    assert touch.by_depth.force_n == by_depth(touch.contact.depth_mm).force_n


def test_a_fingertip_finds_its_dots(pad):
    columns, rows = np.meshgrid(np.arange(7.0), np.arange(7.0))
    free_px = np.stack([columns * 20 + 180, rows * 20 + 180], axis=-1)
    free_mm = np.stack([(columns - 3) * 1.6, (rows - 3) * 1.6, np.full((7, 7), 12.5)], axis=-1)

    def printed(move):
        y, x = np.mgrid[:480, :480]
        far = np.full((480, 480), np.inf)
        for px, py in (free_px + move).reshape(-1, 2):
            far = np.minimum(far, np.hypot(x - px, y - py))
        return (150 - 100 * np.clip(5.5 - far, 0, 1)).astype(np.uint8)

    free = printed([0, 0])
    given = dict(contact=fp.ContactTest(free_apex_mm=13.03), dot_radius_px=5.0)
    fingertip = fp.Fingertip(*pad, free_mm, free_red=free, free_green=free, free_dots_px=free_px,
                             **given)
    frame = printed([1.3, -0.8])
    touch = fingertip(frame, frame)
    assert touch.dots.ok and touch.dots.found == touch.dots.expected == 49
    np.testing.assert_allclose(fingertip.dots_px, free_px + [1.3, -0.8], atol=0.05)
    with pytest.raises(ValueError, match="given together"):
        fp.Fingertip(*pad, free_mm, free_red=free, **given)


def test_a_fingertip_gives_what_its_parts_give(pad, estimate):
    columns, rows = np.meshgrid(np.arange(7), np.arange(7))
    free_dots = np.stack([columns - 3.0, rows - 3.0, np.full((7, 7), 12.5)], axis=-1)
    fingertip = fp.Fingertip(*pad, free_dots, contact=fp.ContactTest(free_apex_mm=13.03))
    red, green = channels(picture("frames/000005.png"))
    dots_px = np.stack([columns * 12.0 + 200, rows * 12.0 + 200], axis=-1)
    touch = fingertip(red, green, dots_px, 0.016, 0.0)
    depth, _, _ = estimate(red, green)
    np.testing.assert_array_equal(fingertip.depth_mm, depth)
    assert touch.contact.in_contact and len(touch.wrench.force_n) == 3
    assert touch.contact.contact_px == (fingertip.contact_mask == 255).sum()
    header = (DATA.parents[1] / "include/fingerpad/pipeline/fingertip_options.hpp").read_text()
    body = header.split("struct [[nodiscard]] FingertipResult {")[1].split("};")[0]
    fields = re.findall(r"(?:^  \w[\w<>]* |, )(\w+)(?=;| = |, \w+;)", body, re.MULTILINE)
    assert {"status", "flat_area", "by_area", "by_depth", "wrench"} <= set(fields)
    for field in fields:
        part = getattr(touch, field)
        assert field == "status" or all(getattr(part, name) is not None for name in dir(part) if name[0] != "_")
    assert touch.flat_area.area_mm2 > 0 and touch.flat_area.variance_mm4 > 0
    with pytest.raises(TypeError, match=r"\(rows, cols, 2\)"):
        fingertip(red, green, free_dots, 0.016)
    assert fingertip(red, green, dots_px[1:], 0.016).status == "refused"


def test_results_print_their_numbers_and_settings_their_keywords(pad, estimate):
    red, green = channels(picture("frames/000005.png"))
    depth, _, result = estimate(red, green)
    assert repr(result).startswith("DepthResult(ok=True, status='ok', pad_pixels=")
    assert f"valid_pixels={np.isfinite(depth).sum()}" in repr(result)
    assert result.pixels(fp.PixelStatus.ok) == result.valid_pixels
    touch = fp.Fingertip(*pad, np.full((3, 3, 3), np.nan))(red, green, np.full((3, 3, 2), np.nan), 0.016)
    assert "wrench=WrenchResult(ok=False, status='" in repr(touch) and " object at 0x" not in repr(touch)
    said = str(inspect.signature(fp.Camera))
    assert said.startswith("(*, plate_distance_mm=50.0, ") and "pitch_mm=" in said
    assert "slip_share" in pydoc.plain(pydoc.render_doc(fp.StickOptions))
    with pytest.raises(fp.ParameterError, match="slip_share = 0"):
        fp.StickOptions(slip_share=0)


def test_dots_of_single_precision_give_the_same_answer():
    columns, rows = np.meshgrid(np.arange(9.0), np.arange(9.0))
    dots, touching = np.stack([columns * 12, rows * 12], axis=-1), np.ones((9, 9), bool)
    ratios = [fp.StickRatio(9, 9), fp.StickRatio(9, 9)]
    for shift in (0, 1, 2, 4):
        seen = [ratio((dots + [shift, 0]).astype(kind), touching, 0.1 * shift)[1]
                for ratio, kind in zip(ratios, (np.float32, np.float64))]
    assert repr(seen[0]) == repr(seen[1])


def test_stubs_are_python_and_name_everything():
    sys.path.insert(0, str(Path(__file__).parent))
    import stubs
    tree = ast.parse(stubs.text_of(fp.__file__))
    named = {node.name for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert named == {name for name in dir(fp) if name[0] != "_"}


def test_the_wheel_holds_the_module_and_its_record(tmp_path):
    script = Path(__file__).with_name("wheel.py")
    packed = subprocess.run([sys.executable, script, fp.__file__, "9.8.7", tmp_path],
                            capture_output=True, text=True, check=True)
    wheel = Path(packed.stdout.strip())
    assert wheel.name.startswith("fingerpad-9.8.7-cp")
    unpacked = tmp_path / "unpacked"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(unpacked)
        names = archive.namelist()
    with open(unpacked / "fingerpad-9.8.7.dist-info" / "RECORD", newline="") as record:
        rows = list(csv.reader(record))
    assert [row[0] for row in rows] == names
    for name, digest, size in rows[:-1]:  # the record does not list itself
        content = (unpacked / name).read_bytes()
        assert len(content) == int(size)
        expected = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=")
        assert digest == f"sha256={expected.decode()}"
    said = subprocess.run([sys.executable, "-c", "import fingerpad; print(fingerpad.__file__)"],
                          env={**os.environ, "PYTHONPATH": str(unpacked)}, cwd=unpacked,
                          capture_output=True, text=True, check=True).stdout
    assert said.startswith(str(unpacked))
