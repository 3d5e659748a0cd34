// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Contact of a ball on a gel in rendered frames of 640 x 480 pixels (three colours, dots, 1 grey
// level of noise). Errors, over 24 balls and 24 free frames: the relative excess of the area over
// the true contact, since the dent of the gel around the ball is visible too; the distance of its
// center from the true one; and the share of a free frame that is taken for contact.
#include "fingerpad/gel/gel_contact.hpp"

#include <memory>
#include <opencv2/imgproc.hpp>
#include <span>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "support/gel_frames.hpp"

using namespace fingerpad;
using test::BallOnGel;
using test::GelPad;

namespace {

constexpr std::size_t pixels = 640 * 480;

struct Scenes {
  test::GelCamera camera{.rows = 480, .cols = 640, .mm_per_px = 0.04};
  std::vector<cv::Mat> free, pressed;
  std::vector<BallOnGel<>> contacts;

  explicit Scenes(int count) {
    test::Random random(11);
    for (int k = 0; k < count; ++k) {
      BallOnGel<> contact(GelPad{});
      free.push_back(test::mat_of(camera.frame(contact, random)));
      contact.drag(random.uniform(0.2, 1.5), {random.uniform(-4, 4), random.uniform(-3, 3)});
      contacts.push_back(contact);
      pressed.push_back(test::mat_of(camera.frame(contact, random)));
    }
  }
};

struct Errors {
  std::vector<double> area, center_mm, free;
};

Errors errors_of(GelContact& contact, const Scenes& scenes) {
  Errors errors;
  for (std::size_t k = 0; k < scenes.pressed.size(); ++k) {
    const double radius_px = scenes.contacts[k].radius_mm() / scenes.camera.mm_per_px;
    const GelResult found = contact(scenes.pressed[k]);
    errors.area.push_back(found.contact_px / (3.14159265358979 * radius_px * radius_px) - 1);
    errors.center_mm.push_back(norm(scenes.camera.mm_of(found.center_px.y, found.center_px.x) -
                                    scenes.contacts[k].ball_mm()));
    errors.free.push_back(static_cast<double>(contact(scenes.free[k]).contact_px) / pixels);
  }
  return errors;
}

void add_contact(const std::string& name,
                 bool imprint,
                 const std::shared_ptr<const Scenes>& scenes) {
  const bench::Memory memory;
  const auto contact = std::make_shared<GelContact>(
      std::span(scenes->free).first(3),
      GelOptions{.dot_px = scenes->camera.dot_mm / scenes->camera.mm_per_px});
  bench::add(
      "gel 640x480/" + name, pixels, memory.bytes(),
      [=] {
        benchmark::DoNotOptimize((*contact)(scenes->pressed[0]));
        if (imprint) {
          benchmark::DoNotOptimize(contact->imprint());
        }
      },
      [=](auto& counters) {
        const Errors errors = errors_of(*contact, *scenes);
        bench::note_errors(counters, "area", "share", errors.area);
        bench::note_errors(counters, "center", "mm", errors.center_mm);
        bench::note_errors(counters, "contact on a free pad", "share", errors.free);
      });
}

/// The same steps in OpenCV at full size: Gaussian means, difference, opening, closing.
void add_opencv(const std::shared_ptr<const Scenes>& scenes) {
  const auto work = [=, smooth = cv::Mat(), free = cv::Mat(), length = cv::Mat(), mask = cv::Mat(),
                     shape = cv::getStructuringElement(cv::MORPH_ELLIPSE, {15, 15})]() mutable {
    if (free.empty()) {
      cv::GaussianBlur(scenes->free[0], free, {}, 7);
    }
    cv::GaussianBlur(scenes->pressed[0], smooth, {}, 7);
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
  add_contact("default", false, scenes);
  add_contact("with its imprint", true, scenes);
  bench::add_streaming("gel 640x480", pixels);
  add_opencv(scenes);
  return bench::run(argc, argv);
}
