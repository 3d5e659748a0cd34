// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Frames of dots as the stick ratio reads and stores them: points in the order of the dot grid, NaN
// for a missing dot. NaN makes every comparison false, so a missing dot needs no flag.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/stick_result.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// Upper limit of squared distances between dots. NaN is not a distance either.
template <class S>
constexpr S no_distance_sq() {
  return S(1e18);
}
template <class S>
constexpr bool is_distance_sq(const S& sq) {
  return sq < no_distance_sq<S>();
}

template <class P>
using coordinate = decltype(P::x);

/// A missing dot: all coordinates are NaN.
template <class P>
constexpr P no_dot() {
  constexpr auto nan = [] { return not_a_number<coordinate<P>>(); };
  if constexpr (requires(P p) { p.z; }) {
    return {nan(), nan(), nan()};
  } else {
    return {nan(), nan()};
  }
}

struct DotLayout {
  Index rows = 0;
  Index cols = 0;

  Index size() const { return rows * cols; }
  DotIndex dot_at(Index k) const { return {k / cols, k % cols}; }
  friend constexpr bool operator==(const DotLayout&, const DotLayout&) = default;
};

/// DotLayout::dot_at() for ascending indices, without a division for each.
class DotWalk {
 public:
  explicit DotWalk(const DotLayout& layout) : cols_(layout.cols) {}

  DotIndex to(Index k) {
    for (; k - first_ >= cols_; first_ += cols_) {
      ++row_;
    }
    return {row_, k - first_};
  }

 private:
  Index cols_, row_ = 0, first_ = 0;
};

template <class P>
using Dots = std::vector<P>;

template <class P>
const P& at(const Dots<P>& dots, Index k) {
  return dots[static_cast<std::size_t>(k)];
}
template <class P>
P& at(Dots<P>& dots, Index k) {
  return dots[static_cast<std::size_t>(k)];
}

/// The dot `down` rows and `right` columns from dot d; NaN outside of the grid.
template <class P>
P beside(const P* dots, const DotLayout& layout, const DotIndex& d, Index down, Index right) {
  const bool inside = d.row + down >= 0 && d.row + down < layout.rows && d.col + right >= 0 &&
                      d.col + right < layout.cols;
  return inside ? dots[(d.row + down) * layout.cols + d.col + right] : no_dot<P>();
}
/// The same from dot k. Takes a division: for several neighbours, call dot_at(k) once instead.
template <class P>
P beside(const P* dots, const DotLayout& layout, Index k, Index down, Index right) {
  return beside(dots, layout, layout.dot_at(k), down, right);
}

/// A frame as it was given, of points in the image or in space.
template <class P>
struct GivenDots {
  Dots<P> found;                   ///< NaN for a dot not found
  ReservedVector<Index> touching;  ///< the cells flagged as in contact, found or not
  Index count = 0;                 ///< number of dots found

  GivenDots() = default;
  explicit GivenDots(const DotLayout& layout)
      : found(static_cast<std::size_t>(layout.size()), no_dot<P>()), touching(found.size()) {}

  template <class DotsView, class Contact>
  void read(const DotsView& dots, const Contact& contact) {
    using Traits = point_traits<cell_t<DotsView>>;
    touching.clear();
    count = 0;
    Index zeros = 0, minus_ones = 0;
    Index k = 0;
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j, ++k) {
        const cell_t<DotsView> given = dots(i, j);
        P p = no_dot<P>();
        p.x = coordinate<P>(Traits::x(given));
        p.y = coordinate<P>(Traits::y(given));
        if constexpr (requires { p.z; }) {
          p.z = coordinate<P>(Traits::z(given));
        }
        // quick test: a smaller sum of squares is always plausible
        const bool there = squared_norm(p) < square(coordinate<P>(1000000)) || is_plausible(p);
        at(found, k) = there ? p : no_dot<P>();
        count += there ? 1 : 0;
        if (p.x == p.y) {
          zeros += is_filled(p, coordinate<P>(0)) ? 1 : 0;
          minus_ones += is_filled(p, coordinate<P>(-1)) ? 1 : 0;
        }
        if (is_contact(cell_t<Contact>(contact(i, j)))) {
          touching.push_back(k);
        }
      }
    }
    leave_out(coordinate<P>(0), zeros);
    leave_out(coordinate<P>(-1), minus_ones);
  }

  /// Whether the contact reaches all four sides of the pattern, and no dot was found outside of it.
  bool all_touch(const DotLayout& layout) const {
    DotIndex first = {layout.rows, layout.cols}, last;
    Index dots = 0;
    for (const Index k : touching) {
      if (is_finite(at(found, k))) {
        const DotIndex d = layout.dot_at(k);
        first = {(std::min)(first.row, d.row), (std::min)(first.col, d.col)};
        last = {(std::max)(last.row, d.row), (std::max)(last.col, d.col)};
        ++dots;
      }
    }
    return dots == count && first.row == 0 && first.col == 0 && last.row == layout.rows - 1 &&
           last.col == layout.cols - 1;
  }

 private:
  static bool is_filled(const P& p, const coordinate<P>& c) {
    if constexpr (requires { p.z; }) {
      return p.x == c && p.y == c && p.z == c;
    } else {
      return p.x == c && p.y == c;
    }
  }

  /// Removes dots at a position that marks lost dots in other software, if several dots share it.
  void leave_out(const coordinate<P>& mark, Index marked) {
    if (marked > 1) {
      std::replace_if(
          found.begin(), found.end(), [&](const P& p) { return is_filled(p, mark); }, no_dot<P>());
      count -= marked;
    }
  }
};

/// The latest frames, at most `capacity`; a new frame replaces the oldest.
template <class P>
class Repository {
 public:
  Repository() = default;
  Repository(const DotLayout& layout, Index capacity)
      : cells_(layout.size()),
        dots_(static_cast<std::size_t>(cells_ * capacity)),
        frames_(static_cast<std::size_t>(capacity)) {}

  Index size() const { return size_; }
  Index capacity() const { return static_cast<Index>(frames_.size()); }

  /// `age` 0 is the newest frame.
  const P* dots(Index age) const { return dots_.data() + slot(age) * cells_; }
  std::int64_t frame(Index age) const { return frames_[static_cast<std::size_t>(slot(age))]; }

  void store(const Dots<P>& dots, std::int64_t frame) {
    newest_ = newest_ + 1 < capacity() ? newest_ + 1 : 0;
    size_ = size_ < capacity() ? size_ + 1 : size_;
    frames_[static_cast<std::size_t>(newest_)] = frame;
    std::copy(dots.begin(), dots.end(), dots_.begin() + newest_ * cells_);
  }
  void clear() { size_ = 0; }

 private:
  Index slot(Index age) const {
    return newest_ >= age ? newest_ - age : newest_ - age + capacity();
  }

  Index cells_ = 0;
  Dots<P> dots_;
  std::vector<std::int64_t> frames_;
  Index newest_ = -1;
  Index size_ = 0;
};

/// Times of the frames of a recording. Times that are not finite are unknown.
class Clock {
 public:
  /// Sets the time of a frame. True if it is more than `hold_s` before the latest one: another
  /// recording has begun.
  bool goes_back(double time_s, double hold_s) {
    const bool back = time_s < latest_s_ - hold_s;
    if (back) {
      *this = Clock();
    }
    now_s_ = time_s;
    latest_s_ = is_finite(time_s) && latest_s_ < time_s ? time_s : latest_s_;
    return back;
  }
  void touch() { contact_s_ = is_finite(now_s_) ? now_s_ : contact_s_; }
  /// Whether the last frame with contact is at most `hold_s` ago.
  bool touched_within(double hold_s) const { return now_s_ - contact_s_ <= hold_s; }

 private:
  static constexpr double never = -std::numeric_limits<double>::infinity();
  double now_s_ = never;
  double latest_s_ = never;
  double contact_s_ = never;
};

/// d_max^2: the largest squared displacement of a dot of `touching` found in both frames; -1 if
/// there is none.
template <class P>
auto furthest_sq(const std::vector<Index>& touching, const P* now, const P* before)
    -> decltype(squared_norm(*now)) {
  using S = decltype(squared_norm(*now));
  S furthest = S(-1);
  for (const Index k : touching) {
    const S sq = squared_norm(now[k] - before[k]);
    furthest = furthest < sq ? sq : furthest;
  }
  return furthest;
}

/// Whether the dots have moved back toward their free positions, to within 45 degrees; false if
/// these are not known. Only x and y count, because the depth of a contact depends on its load.
template <class P>
bool falls_back(const std::vector<Index>& touching,
                const P* now,
                const P* then,
                const Dots<P>& free) {
  using S = coordinate<P>;
  using std::sqrt;
  const auto apart_sq = [](const P& a, const P& b) {
    return S((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
  };
  S then_sq = S(0), now_sq = S(0), moved_sq = S(0);
  for (const Index k : touching) {
    const S before = apart_sq(then[k], at(free, k));
    const S after = apart_sq(now[k], at(free, k));
    const S moved = apart_sq(now[k], then[k]);
    if (is_distance_sq(before) && is_distance_sq(after) && is_distance_sq(moved)) {
      then_sq = then_sq + before;
      now_sq = now_sq + after;
      moved_sq = moved_sq + moved;
    }
  }
  const S nearer_sq = then_sq + now_sq - S(2) * S(sqrt(S(then_sq * now_sq)));
  return now_sq < then_sq && moved_sq < S(2) * nearer_sq;
}

/// Two frames to compare.
template <class S>
struct FramePair {
  const Point2<S>* now;
  const Point2<S>* then;
  const std::vector<Index>& touching;  ///< dots now in contact
  DotLayout layout;
  S furthest_sq;  ///< d_max^2
};

/// The stored frame with which the present one is compared.
template <class S>
struct Choice {
  Index age = -1;         ///< in the repository; -1: no frame is suitable
  S furthest_sq = S(-1);  ///< d_max^2 from it; else from the newest stored frame
  S newest_sq = S(-1);    ///< d_max^2 from the newest stored frame, to detect a jump of labels; -1:
                          ///< there is none
  bool standing = false;
};

/// Updates the marks of the dots: those no longer in contact have none, those newly in contact are
/// unknown. Counts the marks and writes them to `to`.
template <class Result, class States>
void settle_marks(const DotLayout& layout,
                  const std::vector<Index>& all_touching,
                  std::vector<DotState>& marks,
                  Result& result,
                  const States& to) {
  result.stick = result.slip = result.unknown = 0;
  auto mark = marks.begin();
  for (const Index k : all_touching) {
    const auto touching = marks.begin() + k;
    mark = std::fill_n(mark, touching - mark, DotState::none);
    *mark = *mark == DotState::none ? DotState::unknown : *mark;
    result.stick += *mark == DotState::stick ? 1 : 0;
    result.slip += *mark == DotState::slip ? 1 : 0;
    result.unknown += *mark == DotState::unknown ? 1 : 0;
    ++mark;
  }
  std::fill(mark, marks.end(), DotState::none);
  mark = marks.begin();
  for (Index i = 0; i < layout.rows; ++i) {
    for (Index j = 0; j < layout.cols; ++j, ++mark) {
      to(i, j) = static_cast<cell_t<States>>(*mark);
    }
  }
}

/// Whether slipping dots cannot be distinguished from dots outside of the contact: all dots are
/// flagged as in contact, and more than a tenth slip, where noise alone causes a hundredth.
template <class Result, class P>
bool lacks_outline(const Result& result, const DotLayout& layout, const GivenDots<P>& given) {
  return 10 * result.slip > result.stick + result.slip && given.all_touch(layout);
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
