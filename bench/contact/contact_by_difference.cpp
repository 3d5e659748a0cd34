// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Contact of a ball on a gel in rendered frames of 640 x 480 pixels (three colours, dots, 1 grey
// level of noise). Errors, over 24 balls and 24 free frames: the relative excess of the area over
// the true contact, since the dent of the gel around the ball is visible too; the distance of its
// center from the true one; and the share of a free frame that is taken for contact.
#include "fingerpad/contact/contact_by_difference.hpp"

#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "support/gel_frames.hpp"

using namespace fingerpad;
using test::ColourFrame;
using test::Image;

namespace {

constexpr std::size_t pixels = 640 * 480;

struct Scenes {
  test::GelCamera camera{.rows = 480, .cols = 640, .mm_per_px = 0.04};
  std::vector<ColourFrame> free, pressed;
  std::vector<GelContact<>> contacts;

  explicit Scenes(int count) {
    test::Random random(11);
    for (int k = 0; k < count; ++k) {
      GelContact<> contact(GelPad{});
      free.push_back(camera.frame(contact, random));
      contact.drag(random.uniform(0.2, 1.5), {random.uniform(-4, 4), random.uniform(-3, 3)});
      contacts.push_back(contact);
      pressed.push_back(camera.frame(contact, random));
    }
  }
};

DifferenceTest test_of(const Scenes& scenes) {
  DifferenceTest test;
  test.dot_px = scenes.camera.dot_mm / scenes.camera.mm_per_px;
  test.mm_per_px = scenes.camera.mm_per_px;
  return test;
}

struct Errors {
  std::vector<double> area, center_mm, free;
};

template <class Region>
Errors errors_of(const Region& region, const Scenes& scenes) {
  auto workspace = region.workspace();
  Image<std::uint8_t> mask(480, 640);
  Errors errors;
  for (std::size_t k = 0; k < scenes.pressed.size(); ++k) {
    const double radius = scenes.contacts[k].radius_mm();
    const auto ball = scenes.contacts[k].ball_mm();
    const ContactResult found = region(scenes.pressed[k], mask, workspace);
    errors.area.push_back(found.area_mm2 / (3.14159265358979 * radius * radius) - 1);
    errors.center_mm.push_back(std::hypot(found.center_mm.x - ball.x, found.center_mm.y - ball.y));
    const ContactResult nothing = region(scenes.free[k], mask, workspace);
    errors.free.push_back(static_cast<double>(nothing.contact_px) / pixels);
  }
  return errors;
}

template <class S>
void add_region(const std::string& name, const std::shared_ptr<const Scenes>& scenes) {
  using Region = ContactByDifference<3, S>;
  const bench::Memory memory;
  const std::vector<ColourFrame> free(scenes->free.begin(), scenes->free.begin() + 3);
  const auto region = std::make_shared<Region>(free, test_of(*scenes));
  const auto workspace = std::make_shared<typename Region::Workspace>(*region);
  const auto mask = std::make_shared<Image<std::uint8_t>>(480, 640);
  bench::add(
      "gel 640x480/" + name, pixels, memory.bytes(),
      [=] { benchmark::DoNotOptimize((*region)(scenes->pressed[0], *mask, *workspace)); },
      [=](auto& counters) {
        const Errors errors = errors_of(*region, *scenes);
        bench::note_errors(counters, "area", "share", errors.area);
        bench::note_errors(counters, "center", "mm", errors.center_mm);
        bench::note_errors(counters, "contact on a free pad", "share", errors.free);
      });
}

/// The same steps in OpenCV at full size: Gaussian means, difference, opening, closing.
void add_opencv(const std::shared_ptr<const Scenes>& scenes) {
  const auto as_mat = [](const ColourFrame& frame) {
    return cv::Mat(480, 640, CV_8UC3, const_cast<std::array<std::uint8_t, 3>*>(frame.cells.data()));
  };
  const auto work = [=, smooth = cv::Mat(), free = cv::Mat(), length = cv::Mat(), mask = cv::Mat(),
                     shape = cv::getStructuringElement(cv::MORPH_ELLIPSE, {15, 15})]() mutable {
    if (free.empty()) {
      cv::GaussianBlur(as_mat(scenes->free[0]), free, {}, 7);
    }
    cv::GaussianBlur(as_mat(scenes->pressed[0]), smooth, {}, 7);
    cv::absdiff(smooth, free, smooth);
    cv::cvtColor(smooth, length, cv::COLOR_BGR2GRAY);
    cv::threshold(length, mask, 5, 255, cv::THRESH_BINARY);
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN, shape);
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, shape);
  };
  bench::add("gel 640x480/cv::GaussianBlur, absdiff, threshold and morphologyEx", pixels,
             static_cast<long>(pixels * (3 + 3 + 1 + 1)), work, [](auto&) {});
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const auto scenes = std::make_shared<const Scenes>(24);
  add_region<float>("default", scenes);
  add_region<double>("double", scenes);
  bench::add_streaming("gel 640x480", pixels);
  add_opencv(scenes);
  return bench::run(argc, argv);
}
