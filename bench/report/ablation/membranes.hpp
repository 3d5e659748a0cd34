// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finite-element membranes (tests/data/README.md) as shapes, as frames of 640 x 480 pixels and as
// known contact. The scenes:
//   free                 the pad that nothing touches
//   press                flat plate, 3.5 mm deep
//   drag                 flat plate dragged half way to slip, and slipping
//   reversal             the same half way back
//   twist                flat plate rotated half way to slip, and slipping
//   normal force change  flat plate deeper step by step while it is dragged and rotated
//   rolling              ball of 18 mm, half way of rolling
//   wedge                cylinder of 12 mm, pressed, and dragged: an edge, as it were
//   tilted               plate tilted by 8 degrees, pressed, and dragged
//   noisy                the press with twice the noise: 2 grey levels
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "fingerpad/optics/camera.hpp"
#include "support/finite_elements.hpp"
#include "table.hpp"

namespace bench::ablation {

using fingerpad::Camera;
using fingerpad::Index;
using test::base_radius_mm;
using test::depths;
using test::frame_of;
using test::Image;
using test::Membrane;
using test::reference_of;

/// Shapes by scene; `heights` is the name of the data. Depth, contact and force use the same
/// shapes.
struct ShapeOfScene {
  Scene scene;
  const char* heights;
  double noise = 1;  ///< grey levels
};
inline const std::vector<ShapeOfScene>& shapes() {
  static const std::vector<ShapeOfScene> all = {{Scene::free, "free"},
                                                {Scene::press, "press"},
                                                {Scene::drag, "wrench_drag_a"},
                                                {Scene::drag, "wrench_drag_b"},
                                                {Scene::reversal, "wrench_drag_c"},
                                                {Scene::twist, "wrench_twist_a"},
                                                {Scene::twist, "wrench_twist_b"},
                                                {Scene::normal_force_change, "wrench_mix_a"},
                                                {Scene::normal_force_change, "wrench_mix_b"},
                                                {Scene::normal_force_change, "wrench_mix_c"},
                                                {Scene::normal_force_change, "wrench_mix_d"},
                                                {Scene::rolling, "roll"},
                                                {Scene::wedge, "cylinder"},
                                                {Scene::wedge, "wrench_cylinder_b"},
                                                {Scene::tilted, "tilt"},
                                                {Scene::tilted, "wrench_tilt_b"},
                                                {Scene::noisy, "press", 2}};
  return all;
}

/// A shape with the visible point of each pixel and its contact.
struct Seen {
  ShapeOfScene of;
  std::uint64_t seed;
  double area_mm2 = 0;  ///< of the contact
  Image<double> depth_mm;
  Image<fingerpad::Point3<double>> point_mm;
  Image<std::uint8_t> touches;

  Seen(const test::Pad& pad, const ShapeOfScene& shape, std::uint64_t number)
      : of(shape), seed(number), point_mm(pad.rows, pad.cols), touches(pad.rows, pad.cols) {
    depth_mm = depths(pad, Membrane(shape.heights));
    for (Index i = 0; i < pad.rows; ++i) {
      for (Index j = 0; j < pad.cols; ++j) {
        point_mm(i, j) =
            point_at(pad.camera, static_cast<double>(i), static_cast<double>(j), depth_mm(i, j));
      }
    }
    if (shape.scene != Scene::free) {
      mark(test::TrueContact(shape.heights));
    }
  }

 private:
  void mark(const test::TrueContact& contact) {
    area_mm2 = contact.area_mm2();
    for (std::size_t k = 0; k < touches.cells.size(); ++k) {
      const auto& p = point_mm.cells[k];
      touches.cells[k] = !std::isnan(p.z) && contact(p.x, p.y) ? 1 : 0;
    }
  }
};

}  // namespace bench::ablation
