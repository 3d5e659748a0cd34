# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""The Python module on the bundled recording: pytest test_fingerpad.py, with the module's folder in
PYTHONPATH."""
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import fingerpad as fp

PRESS = Path(__file__).parents[1] / "data/press"


def picture(name):
    return np.array(Image.open(PRESS / name))


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
    if kind == np.uint16:  # 16 bit have another full scale: these are dark
        assert not result.ok
    else:
        ok = status == int(fp.PixelStatus.ok)
        assert ok.sum() > 100_000 and np.abs(wide - depth)[ok].max() < 1e-3


def test_views_are_not_copied_and_strides_do_not_matter(pad, estimate):
    red, green = channels(picture("frames/000005.png"))
    assert not red.flags["C_CONTIGUOUS"]
    expected, _, _ = estimate(red, green)
    packed, _, _ = estimate(np.ascontiguousarray(red), np.asfortranarray(green))
    np.testing.assert_array_equal(expected, packed)
    turned, _, _ = estimate(red[::-1, ::-1][::-1, ::-1], green)
    np.testing.assert_array_equal(expected, turned)


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
    with pytest.raises(AttributeError, match="pitch"):
        fp.Camera(pitch=0.1)
    with pytest.raises(ValueError, match="480 x 480"):
        estimate(red[1:], green[1:])
    with pytest.raises(TypeError, match="uint8"):
        estimate(red, green.astype(np.float32))
    with pytest.raises(TypeError, match=r"\(rows, cols\)"):
        estimate(picture("frames/000005.png"), green)
    with pytest.raises(TypeError, match="int32"):
        estimate(red.astype(np.int32), green.astype(np.int32))


def test_a_foam_hand_warns_of_vibration_that_moves_and_quickens():
    hand = fp.FoamHand(4, 4, fp.TaxelOptions(noise=1, sample_period_s=0.01))
    rng = np.random.default_rng(1)
    statuses = []
    for k in range(120):
        readings = [np.full((4, 4), 50.0) + rng.normal(0, 0.5, (4, 4)) for _ in range(2)]
        if k > 60:  # the load moves on, and another taxel vibrates
            readings[0][1, 2] += 20 * (-1) ** k
            readings[0][3, 3] += 200
        felt = hand(readings, 0.01 * k)
        statuses.append(felt.status)
    assert fp.PreslipStatus.preslip not in statuses[:60]
    assert fp.PreslipStatus.preslip in statuses[60:]
    hand.reset()
    assert hand(readings, 0.0).status == fp.PreslipStatus.cannot_tell


def test_a_fingertip_gives_what_its_parts_give(pad, estimate):
    columns, rows = np.meshgrid(np.arange(7), np.arange(7))
    free_dots = np.stack([columns - 3.0, rows - 3.0, np.full((7, 7), 12.5)], axis=-1)
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    rim = 18.735 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)[None]
    side_dots = rim + [0, 0, 0.8]
    fingertip = fp.Fingertip(*pad, free_dots, rim, contact=fp.ContactTest(free_apex_mm=13.03))
    red, green = channels(picture("frames/000005.png"))
    dots_px = np.stack([columns * 12.0 + 200, rows * 12.0 + 200], axis=-1)
    touch = fingertip(red, green, dots_px, side_dots, 0.016, 0.0)
    depth, _, _ = estimate(red, green)
    np.testing.assert_array_equal(fingertip.depth_mm, depth)
    assert touch.contact.in_contact and len(touch.force_n) == 3
    assert touch.contact.contact_px == (fingertip.contact_mask == 255).sum()
    with pytest.raises(TypeError, match=r"\(rows, cols, 2\)"):
        fingertip(red, green, side_dots, side_dots, 0.016)
    assert fingertip(red, green, dots_px[1:], side_dots, 0.016).status == "refused"
