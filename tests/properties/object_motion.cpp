// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every object, every motion and every method.
#include "fingerpad/motion/object_motion.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/rolling.hpp"

using namespace fingerpad;
using test::Dots;
using test::Flags;

namespace {

using Vector = Point3<double>;

Pose<double> any_motion(double turn_rad, double shift_mm) {
  const auto any = [](double size) {
    return Vector{test::uniform(-size, size), test::uniform(-size, size),
                  test::uniform(-size, size)};
  };
  return {test::turned_by(any(turn_rad)), any(shift_mm)};
}

/// Dots on a bumpy cap.
Dots any_dots(Index rows, Index cols) {
  Dots dots(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double x = 1.5 * static_cast<double>(j - cols / 2);
      const double y = 1.5 * static_cast<double>(i - rows / 2);
      dots(i, j) = {x + test::uniform(-0.1, 0.1), y + test::uniform(-0.1, 0.1),
                    12 - (x * x + y * y) / 40 + test::uniform(-0.1, 0.1)};
    }
  }
  return dots;
}

Flags any_contact(Index rows, Index cols) {
  Flags flags(rows, cols, 0);
  const double i0 = test::uniform(2, static_cast<double>(rows) - 3);
  const double j0 = test::uniform(2, static_cast<double>(cols) - 3);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      flags(i, j) =
          std::hypot(static_cast<double>(i) - i0, static_cast<double>(j) - j0) < 2.9 ? 1 : 0;
    }
  }
  return flags;
}

Dots moved(Dots dots, const Pose<double>& pose) {
  for (auto& p : dots.cells) {
    p = pose(p);
  }
  return dots;
}

Dots shaken(Dots dots, double mm) {
  for (auto& p : dots.cells) {
    p = {p.x + test::uniform(-mm, mm), p.y + test::uniform(-mm, mm), p.z + test::uniform(-mm, mm)};
  }
  return dots;
}

template <class S>
double distance(const Pose<S>& a, const Pose<S>& b) {
  double worst = 0;
  for (int i = 0; i < 9; ++i) {
    const S d = a.rotation.m[i / 3][i % 3] - b.rotation.m[i / 3][i % 3];
    worst = (std::max)(worst, std::abs(static_cast<double>(d)));
  }
  const Point3<S> t = a.translation_mm - b.translation_mm;
  return worst + std::sqrt(static_cast<double>(squared_norm(t)));
}

struct Scene {
  Dots free;
  std::vector<Dots> dots;
  std::vector<Flags> contact;
};

/// A few frames of a rigidly moving object with some noise.
Scene any_scene(double noise_mm) {
  const Index rows = test::whole(7, 10), cols = test::whole(7, 10);
  Scene s{any_dots(rows, cols), {}, {}};
  const Flags contact = any_contact(rows, cols);
  Dots dots = s.free;
  for (int k = 0; k < 4; ++k) {
    dots = moved(dots, any_motion(0.2, 0.5));
    s.dots.push_back(shaken(dots, noise_mm));
    s.contact.push_back(contact);
  }
  return s;
}

Pose<double> pose_after(const Scene& s) {
  ObjectMotion<> motion(s.free.rows(), s.free.cols());
  Pose<double> pose;
  for (std::size_t k = 0; k < s.dots.size(); ++k) {
    const auto result = motion(s.dots[k], s.contact[k]);
    RC_ASSERT(result.ok());
    pose = result.pose;
  }
  return pose;
}

template <class Map>
Scene mapped(const Scene& s, const Map& map) {
  Scene out{map(s.free), {}, {}};
  for (std::size_t k = 0; k < s.dots.size(); ++k) {
    out.dots.push_back(map(s.dots[k]));
    out.contact.push_back(map(s.contact[k]));
  }
  return out;
}

bool finite(const ObjectMotionResult<double>& r) {
  bool all = is_finite(r.residual_rms_mm) && is_finite(r.angles.x_rad) &&
             is_finite(r.angles.y_rad) && is_finite(r.angles.z_rad) &&
             is_plausible(r.pose.translation_mm);
  for (int i = 0; i < 9; ++i) {
    all = all && is_finite(r.pose.rotation.m[i / 3][i % 3]);
  }
  return all && (!r.ok() || (is_finite(r.position_mm.x) && is_finite(r.displacement_mm.z)));
}

}  // namespace

TEST_CASE("a rigid motion of all dots is found", "[object_motion][law]") {
  rc::prop("to roundoff, through any number of frames", [] {
    const Dots free = any_dots(9, 9);
    const Flags contact = any_contact(9, 9);
    ObjectMotion<> motion(9, 9);
    const Dots first = moved(free, any_motion(0.1, 1));
    RC_ASSERT(motion(first, contact).begun);
    Pose<double> pose;
    for (int k = 0; k < 6; ++k) {
      pose = any_motion(0.3, 1) * pose;
      const auto result = motion(moved(first, pose), contact);
      RC_ASSERT(result.ok());
      RC_ASSERT(distance(result.pose, pose) < 2e-12);
      RC_ASSERT(result.residual_rms_mm < 1e-12);
      const auto again = rotation_of(result.angles);
      RC_ASSERT(distance(Pose<double>{again, {}}, Pose<double>{pose.rotation, {}}) < 1e-12);
    }
    // and back
    RC_ASSERT(distance(motion(first, contact).pose, Pose<double>()) < 2e-12);
  });
  rc::prop("in float, to its roundoff", [] {
    const Dots free = any_dots(9, 9);
    const Flags contact = any_contact(9, 9);
    ObjectMotion<float> motion(9, 9);
    (void)motion(free, contact);
    const Pose<double> pose = any_motion(1, 2);
    const auto result = motion(moved(free, pose), contact);
    RC_ASSERT(result.ok());
    Pose<float> single;
    for (int i = 0; i < 9; ++i) {
      single.rotation.m[i / 3][i % 3] = static_cast<float>(pose.rotation.m[i / 3][i % 3]);
    }
    single.translation_mm = {static_cast<float>(pose.translation_mm.x),
                             static_cast<float>(pose.translation_mm.y),
                             static_cast<float>(pose.translation_mm.z)};
    RC_ASSERT(distance(result.pose, single) < 1e-4);
  });
}

TEST_CASE("a scene seen mirrored, transposed or rotated gives that motion",
          "[object_motion][law]") {
  rc::prop("with noise", [] {
    const Scene scene = any_scene(0.05);
    const Pose<double> pose = pose_after(scene);
    const auto seen = [&](const auto& place, const auto& point, bool swaps) {
      const auto map = [&](const auto& grid) {
        auto out = grid;
        out = std::decay_t<decltype(grid)>(swaps ? grid.cols() : grid.rows(),
                                           swaps ? grid.rows() : grid.cols());
        for (Index i = 0; i < grid.rows(); ++i) {
          for (Index j = 0; j < grid.cols(); ++j) {
            const auto [r, c] = place(i, j, grid.rows(), grid.cols());
            if constexpr (std::is_same_v<std::decay_t<decltype(grid)>, Dots>) {
              out(r, c) = point(grid(i, j));
            } else {
              out(r, c) = grid(i, j);
            }
          }
        }
        return out;
      };
      const Pose<double> other = pose_after(mapped(scene, map));
      for (const Vector& p : {Vector{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
        const Vector off = other(point(p)) - point(pose(p));
        RC_ASSERT(squared_norm(off) < 1e-20);
      }
    };
    using At = std::pair<Index, Index>;
    seen([](Index i, Index j, Index, Index cols) { return At(i, cols - 1 - j); },
         [](const Vector& p) {
           return Vector{-p.x, p.y, p.z};
         },
         false);
    seen([](Index i, Index j, Index rows, Index) { return At(rows - 1 - i, j); },
         [](const Vector& p) {
           return Vector{p.x, -p.y, p.z};
         },
         false);
    seen([](Index i, Index j, Index, Index) { return At(j, i); },
         [](const Vector& p) {
           return Vector{p.y, p.x, p.z};
         },
         true);
    // deeper, because a dot that the turn puts above the plate is a missing one
    const Pose<double> turn{rotation_of(Angles<double>{0.3, 0.5, -0.7}), {0, 0, 30}};
    seen([](Index i, Index j, Index, Index) { return At(i, j); },
         [&](const Vector& p) { return turn(p); }, false);
  });
}

TEST_CASE("dots that come and go never give a wrong or a meaningless pose",
          "[object_motion][law]") {
  rc::prop("of a rigid motion", [] {
    const Dots free = any_dots(9, 9);
    const Flags contact = any_contact(9, 9);
    ObjectMotion<> motion(9, 9);
    RC_ASSERT(motion(free, contact).begun);
    Pose<double> pose;
    const auto share = test::whole(0, 90);
    for (int k = 0; k < 12; ++k) {
      pose = any_motion(0.1, 0.5) * pose;
      Dots dots = moved(free, pose);
      Flags flags = contact;
      for (std::size_t c = 0; c < dots.cells.size(); ++c) {
        if (test::whole(0, 99) < share) {
          dots.cells[c].z = std::nan("");
          flags.cells[c] = test::whole(0, 1) == 0 ? flags.cells[c] : 0;
        }
      }
      const auto result = motion(dots, flags);
      RC_ASSERT(finite(result));
      if (result.ok()) {
        RC_ASSERT(distance(result.pose, pose) < 1e-10);
      }
      if (result.status == MotionStatus::no_contact) {
        break;  // all remaining dots were out of contact, so the object counts as gone
      }
    }
  });
}

TEST_CASE("no pose spans a slide, and none begins in one", "[object_motion][law]") {
  rc::prop("whichever dots slip", [] {
    const Dots free = any_dots(9, 9);
    const Flags contact = any_contact(9, 9);
    ObjectMotion<> motion(9, 9);
    Index touching = 0;
    for (const auto flag : contact.cells) {
      touching += flag != 0 ? 1 : 0;
    }
    bool slid = false, has_object = false;
    Index objects = 0;
    for (int k = 0; k < 20; ++k) {
      Flags slips(9, 9, 0);
      const auto share = test::whole(0, 100);
      Index steady = 0;
      for (std::size_t c = 0; c < slips.cells.size(); ++c) {
        slips.cells[c] = test::whole(1, 100) <= share ? 1 : 0;
        steady += contact.cells[c] != 0 && slips.cells[c] == 0 ? 1 : 0;
      }
      const auto result = motion(free, contact, slips);
      const bool slides = 5 * steady < touching || (slid && 2 * steady <= touching);
      RC_ASSERT((result.status == MotionStatus::slipping) == slides);
      RC_ASSERT(result.object == objects + (result.begun ? 1 : 0));
      RC_ASSERT(!result.begun || !has_object);
      objects = result.object;
      has_object = !slides && (has_object || result.begun);
      slid = slides || (slid && !result.begun);
    }
  });
}

TEST_CASE("nothing is worse than a status", "[object_motion][law]") {
  rc::prop("whatever the dots, the flags and the sizes", [] {
    const Index rows = test::whole(0, 7), cols = test::whole(0, 7);
    const auto bad = [](double good) {
      const double infinity = std::numeric_limits<double>::infinity();
      const double max = std::numeric_limits<double>::max();
      return *rc::gen::element(good, good, good, good, good, good, 0.0, 1e-310, 1e5, max, -max,
                               std::nan(""), infinity, -infinity);
    };
    const auto any = [&](Index r, Index c) {
      Dots dots(r, c);
      const auto kind = test::whole(0, 3);
      for (Index i = 0; i < r; ++i) {
        for (Index j = 0; j < c; ++j) {
          const double x = static_cast<double>(j), y = static_cast<double>(i);
          dots(i, j) = kind == 0   ? Vector{3, 4, 5}
                       : kind == 1 ? Vector{x, x, x}
                       : kind == 2 ? Vector{x, y, test::uniform(9, 10)}
                                   : Vector{bad(x), bad(y), bad(9)};
        }
      }
      return dots;
    };
    ObjectMotion<> motion(rows, cols);
    ObjectMotion<float> in_float(rows, cols);
    for (int k = 0; k < 5; ++k) {
      const bool other = test::whole(0, 9) == 0;
      const Dots dots = any(rows + (other ? 1 : 0), cols);
      Flags flags(dots.rows(), cols, 0);
      const auto share = test::whole(0, 120);
      for (auto& f : flags.cells) {
        f = test::whole(0, 99) < share ? 1 : 0;
      }
      const auto result = motion(dots, flags);
      RC_ASSERT(!other || !result.has_pose());
      RC_ASSERT(finite(result));
      RC_ASSERT(!result.ok() || (result.dots_used >= 3 && result.residual_rms_mm >= 0));
      const auto single = in_float(dots, flags);
      RC_ASSERT(!single.ok() || is_finite(single.pose.rotation(0, 0)));
      RC_ASSERT(!single.ok() || is_finite(single.position_mm.z));
    }
  });
}
