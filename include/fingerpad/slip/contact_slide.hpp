// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Detects gross slip of an object on an elastic gel, from its imprint. A slipping object moves past
// dots that hardly move, and its contact shrinks before it is lost. There are two measures, and
// either can raise the alarm:
//   slide  displacement of the imprint relative to the dots in it since the contact began
//   lost   fraction of the largest contact area so far that has been lost
// The dots alone (slip/stick_ratio.hpp) do not show this, because an object that slides as a whole
// leaves them where they are. Use the stick ratio on membranes and this method on gels.
//
// The imprint is any image in which the contact is visible: the difference image of
// GelContact, or a depth map.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/detail/imprint_shift.hpp"

namespace fingerpad {
inline namespace v0 {

/// Thresholds of the slide. They are in dot pitches and fractions, so they hold for pads of any
/// size.
struct SlideTest {
  double pitch_px = 40;     ///< distance of neighbouring dots, > 0
  double cell_px = 4;       ///< pixels of the dots' image per cell of the imprint, > 0
  double max_slide = 0.25;  ///< pitches; the alarm threshold of the slide, > 0
  /// Limits the evidence from lost area to (slide - its standard error) / min_slide, because an
  /// object that is let go shrinks in place. Pitches, in (0, max_slide].
  double min_slide = 0.1;
  double max_lost = 0.25;  ///< fraction of the area; the alarm threshold of the loss, in (0, 1)
  /// An imprint whose correlation with the earlier one is smaller counts as not found; in [0, 1).
  double min_correlation = 0.6;
  Index min_cells = 100;  ///< a smaller area counts as no contact; >= 30
};
inline void expects_valid(const SlideTest& test) {
  constexpr const char* owner = "SlideTest";
  expects(is_finite(test.pitch_px) && test.pitch_px > 0, owner, "pitch_px", test.pitch_px,
          "finite and > 0");
  expects(is_finite(test.cell_px) && test.cell_px > 0, owner, "cell_px", test.cell_px,
          "finite and > 0");
  expects(is_finite(test.max_slide) && test.max_slide > 0, owner, "max_slide", test.max_slide,
          "finite and > 0");
  expects(test.min_slide > 0 && test.min_slide <= test.max_slide, owner, "min_slide",
          test.min_slide, "in (0, max_slide]");
  expects(test.max_lost > 0 && test.max_lost < 1, owner, "max_lost", test.max_lost, "in (0, 1)");
  expects(test.min_correlation >= 0 && test.min_correlation < 1, owner, "min_correlation",
          test.min_correlation, "in [0, 1)");
  expects(test.min_cells >= 30, owner, "min_cells", static_cast<long long>(test.min_cells),
          ">= 30");
}

enum class SlideStatus : std::uint8_t {
  updated,  ///< slide and area are those of this frame
  began,    ///< the first frame of a contact, from which slide and loss are measured
  /// No dot in the contact was found both before and now, or the dots are labelled differently than
  /// before. The last slide is kept.
  no_dots,
  not_found,   ///< the imprint was not found again: the last slide is kept
  no_contact,  ///< the area is below min_cells; after a contact, all of its area counts as lost
  no_edge,     ///< contact fills the image, so that there is no imprint: nothing changes
  refused,     ///< a grid or state has another size: nothing was done
};

/// "updated", "began", ...
constexpr const char* name_of(SlideStatus status) {
  switch (status) {
    case SlideStatus::updated:
      return "updated";
    case SlideStatus::began:
      return "began";
    case SlideStatus::no_dots:
      return "no dots";
    case SlideStatus::not_found:
      return "not found";
    case SlideStatus::no_contact:
      return "no contact";
    case SlideStatus::no_edge:
      return "no edge";
    case SlideStatus::refused:
      return "refused";
  }
  return "unknown";
}

template <scalar S = float>
struct [[nodiscard]] SlideResult {
  SlideStatus status = SlideStatus::refused;
  Index dots = 0;                       ///< dots in contact from which the slide was computed
  Point2<S> imprint_px = {S(0), S(0)};  ///< displacement of the imprint since the contact began
  S imprint_sd_px = S(0);               ///< its standard deviation along each axis
  Point2<S> slide_px = {S(0), S(0)};    ///< displacement of the imprint relative to the dots in it
  /// Rotation of the imprint relative to the dots, from x to y; needs at least 3 dots. The rotation
  /// of a ball does not show, because its imprint does not rotate with it.
  S rotation_rad = S(0);
  S rotation_sd_rad = S(0);  ///< its standard deviation
  S slide = S(0);            ///< |slide_px| in pitches
  S lost = S(0);             ///< fraction of the largest area so far that has been lost, in [0, 1]
  S correlation = S(0);      ///< of the imprint with the earlier one
  /// Evidence for slip: the larger of slide / max_slide and lost / max_lost, the latter as far as
  /// min_slide allows.
  S evidence = S(0);
  bool alarm = false;  ///< evidence > 1

  /// 1 without evidence for slip, falling to 0 at the alarm. FrictionLimit and GripControl take it
  /// in place of a stick ratio; it is fresh if ok().
  S held() const { return evidence < S(1) ? S(S(1) - evidence) : S(0); }
  bool accepted() const { return status != SlideStatus::refused; }
  /// Whether slide and area are those of this frame.
  bool ok() const { return status == SlideStatus::updated || status == SlideStatus::began; }
  bool touches() const { return status != SlideStatus::no_contact; }
};

/// Slide of a contact, frame by frame. Const: threads may share one object, each with its own
/// state. A frame allocates nothing, throws nothing, and takes O(rows cols) time.
template <scalar S = float>
class ContactSlide {
 public:
  /// For imprints of rows x cols cells and dot grids of dot_rows x dot_cols. Refuses bad
  /// parameters (parameter_error).
  ContactSlide(Index rows, Index cols, Index dot_rows, Index dot_cols, const SlideTest& test = {})
      : rows_(rows), cols_(cols), dot_rows_(dot_rows), dot_cols_(dot_cols), test_(test) {
    expects_grid_size("ContactSlide: imprint", rows, cols, 3);
    expects_grid_size("ContactSlide: dots", dot_rows, dot_cols);
    expects_valid(test);
  }

  /// A value: copy it to return to this frame later. It holds all memory that frames need.
  class State {
   public:
    explicit State(const ContactSlide& slide)
        : imprint_(slide.rows_, slide.cols_, 1),
          mask_(slide.rows_, slide.cols_, margin),
          region_(mask_),
          key_(slide.rows_, slide.cols_) {
      const auto dots = static_cast<std::size_t>(slide.dot_rows_ * slide.dot_cols_);
      dots_.resize(dots, missing());
      key_dots_.resize(dots, missing());
      x_.reserve(dots);
      y_.reserve(dots);
    }
    /// Returns to the state before the first frame.
    void reset() {
      began_ = false;
      max_area_ = 0;
      result_ = {};
    }

   private:
    friend class ContactSlide;
    static constexpr Index margin = 3;
    detail::PaddedCells<S> imprint_, mask_, region_;
    detail::ImprintShift<S> key_;
    std::vector<Point2<S>> dots_, key_dots_;
    detail::ReservedVector<S> x_, y_;
    Point2<S> last_shift_ = {S(0), S(0)};
    SlideResult<S> key_result_;
    SlideResult<S> result_;
    Index max_area_ = 0;
    bool began_ = false;
  };
  State start() const { return State(*this); }

  /// Processes a frame with `imprint` (NaN: unknown) and `contact`, cell by cell, and the dots
  /// `dots_px` in pixels (NaN: not found). A cell is cell_px pixels wide.
  template <grid Imprint, contact_mask Contact, dot_grid Dots>
  SlideResult<S> operator()(const Imprint& imprint,
                            const Contact& contact,
                            const Dots& dots_px,
                            State& state) const {
    const auto from = as_view(imprint);
    const auto touch = as_view(contact);
    const auto dots = as_view(dots_px);
    if (from.rows() != rows_ || from.cols() != cols_ || !same_size(from, touch) ||
        dots.rows() != dot_rows_ || dots.cols() != dot_cols_ || state.mask_.rows() != rows_ ||
        state.mask_.cols() != cols_ ||
        state.dots_.size() != static_cast<std::size_t>(dot_rows_ * dot_cols_)) {
      return {};
    }
    const Index area = read(from, touch, dots, state);
    SlideResult<S>& result = state.result_;
    result.dots = 0;
    if (static_cast<double>(area) > filled * static_cast<double>(rows_ * cols_)) {
      result.status = SlideStatus::no_edge;
    } else if (area < test_.min_cells) {
      result.status = SlideStatus::no_contact;
      result.lost = S(state.max_area_ > 0 ? 1 : 0);
      state.began_ = false;
    } else if (!state.began_) {
      begin(area, state);
    } else {
      state.max_area_ = (std::max)(state.max_area_, area);
      result.lost = S(1 - static_cast<double>(area) / static_cast<double>(state.max_area_));
      follow(state);
    }
    const S by_slide = S(result.slide / S(test_.max_slide));
    const S sure = S(result.slide - result.imprint_sd_px / S(test_.pitch_px));
    const S allowed = S(sure / S(test_.min_slide));
    const S by_area = S(result.lost / S(test_.max_lost));
    const S lost = allowed < by_area ? allowed : by_area;
    result.evidence = by_slide < lost ? lost : by_slide;
    result.alarm = S(1) < result.evidence;
    return result;
  }

 private:
  static Point2<S> missing() { return {not_a_number<S>(), not_a_number<S>()}; }
  /// Copies the frame into the state. Returns the contact area in cells.
  template <class From, class Touch, class Dots>
  Index read(const From& from, const Touch& touch, const Dots& dots, State& state) const {
    Index area = 0;
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        state.imprint_(i, j) = S(from(i, j));
        const bool in = is_contact(cell_t<Touch>(touch(i, j)));
        state.mask_(i, j) = in ? S(1) : S(0);
        area += in ? 1 : 0;
      }
    }
    for (Index i = 0; i < dot_rows_; ++i) {
      for (Index j = 0; j < dot_cols_; ++j) {
        const cell_t<Dots> p = dots(i, j);
        using Traits = point_traits<cell_t<Dots>>;
        state.dots_[static_cast<std::size_t>(i * dot_cols_ + j)] = {S(Traits::x(p)),
                                                                    S(Traits::y(p))};
      }
    }
    return area;
  }

  /// Marks the cells of a line that lie within State::margin of a marked one. `to` may be `from`.
  static void grow(const S* from, Index step, Index count, S* to) {
    Index last = -2 * State::margin - 1;  // the last marked cell so far
    for (Index k = 0; k < count + State::margin; ++k) {
      last = k < count && from[k * step] > S(0) ? k : last;
      if (k >= State::margin) {
        to[(k - State::margin) * step] = S(k - last <= 2 * State::margin ? 1 : 0);
      }
    }
  }

  /// Makes this frame the key frame, with which later frames are compared.
  void set_key(State& state) const {
    // the contact and the cells within a square of it
    for (Index i = 0; i < rows_; ++i) {
      grow(state.mask_.row(i), 1, cols_, state.region_.row(i));
    }
    for (Index j = 0; j < cols_; ++j) {
      grow(state.region_.row(0) + j, state.region_.stride(), rows_, state.region_.row(0) + j);
    }
    state.key_.take(state.imprint_, state.region_);
    for (std::size_t k = 0; k < state.dots_.size(); ++k) {
      state.key_dots_[k] = touches(state.dots_[k], state) ? state.dots_[k] : missing();
    }
    state.last_shift_ = {S(0), S(0)};
    state.key_result_ = state.result_;
  }

  bool touches(const Point2<S>& dot, const State& state) const {
    if (!is_finite(dot)) {
      return false;
    }
    const double j = std::floor((static_cast<double>(value(dot.x)) + 0.5) / test_.cell_px);
    const double i = std::floor((static_cast<double>(value(dot.y)) + 0.5) / test_.cell_px);
    return i >= 0 && j >= 0 && i < static_cast<double>(rows_) && j < static_cast<double>(cols_) &&
           S(0) < state.mask_(static_cast<Index>(i), static_cast<Index>(j));
  }

  void begin(Index area, State& state) const {
    state.result_ = {};
    state.result_.status = SlideStatus::began;
    state.result_.correlation = S(1);
    state.max_area_ = area;
    state.began_ = true;
    set_key(state);
  }

  void follow(State& state) const {
    using std::sqrt;
    SlideResult<S>& result = state.result_;
    const S max_shift = S(0.5 * test_.pitch_px / test_.cell_px);
    const auto motion = state.key_.find(state.imprint_, state.last_shift_, max_shift);
    result.correlation = motion.correlation;
    if (motion.correlation < S(test_.min_correlation)) {
      result.status = SlideStatus::not_found;
      set_key(state);
      return;
    }
    state.last_shift_ = motion.shift;
    const Point2<S> imprint = S(test_.cell_px) * motion.shift;
    result.imprint_px = state.key_result_.imprint_px + imprint;
    result.imprint_sd_px = S(sqrt(S(square(state.key_result_.imprint_sd_px) +
                                    S(square(test_.cell_px)) * motion.shift_variance)));
    const DotMotion dots = motion_of_dots(imprint, state);
    result.dots = dots.count;
    result.status = dots.count > 0 ? SlideStatus::updated : SlideStatus::no_dots;
    if (dots.count > 0) {
      result.slide_px = state.key_result_.slide_px + imprint - dots.shift;
      if (dots.count >= 3) {
        const SlideResult<S>& key = state.key_result_;
        result.rotation_rad = S(key.rotation_rad + motion.angle_rad - dots.angle_rad);
        result.rotation_sd_rad =
            S(sqrt(S(square(key.rotation_sd_rad) + motion.angle_variance + dots.angle_variance)));
      }
      result.slide = S(norm(result.slide_px) / S(test_.pitch_px));
    }
    // in motion each frame becomes the key frame of the next; at rest the key frame stays, so that
    // errors do not add up
    const bool moved = S(1) < squared_norm(motion.shift);
    if (moved || motion.correlation < S((1 + test_.min_correlation) / 2) || dots.count == 0) {
      set_key(state);
    }
  }

  struct DotMotion {
    Index count = 0;
    Point2<S> shift = {S(0), S(0)};
    S angle_rad = S(0);
    S angle_variance = S(0);
  };
  /// Median shift and least-squares rotation of the dots that are in contact now and were in the
  /// key frame.
  DotMotion motion_of_dots(const Point2<S>& imprint_px, State& state) const {
    using std::atan2;
    state.x_.clear();
    state.y_.clear();
    Point2<S> was = {S(0), S(0)};
    Point2<S> is = was;
    for_pairs(state, [&](const Point2<S>& key, const Point2<S>& now) {
      state.x_.push_back(S(now.x - key.x));
      state.y_.push_back(S(now.y - key.y));
      was += key;
      is += now;
    });
    DotMotion motion;
    motion.count = static_cast<Index>(state.x_.size());
    if (motion.count == 0) {
      return motion;
    }
    const S count = S(static_cast<double>(motion.count));
    S along = S(0);
    S across = S(0);
    S arms = S(0);
    S moved = S(0);
    for_pairs(state, [&](const Point2<S>& key, const Point2<S>& now) {
      const Point2<S> p = key - was / count;
      const Point2<S> q = now - is / count;
      along = S(along + dot(p, q));
      across = S(across + p.x * q.y - p.y * q.x);
      arms = S(arms + squared_norm(p));
      moved = S(moved + squared_norm(Point2<S>(q - p)));
    });
    motion.shift = {median(state.x_), median(state.y_)};
    if (S(0) < along) {
      motion.angle_rad = S(atan2(across, along));
      // residual sum of squares over its degrees of freedom
      const S left = S(moved - across * motion.angle_rad);
      motion.angle_variance = S(0) < left ? S(left / (S(2) * count - S(3)) / arms) : S(0);
    }
    return are_renamed(motion, imprint_px, state) ? DotMotion{} : motion;
  }
  /// Whether the dots are labelled differently: their shift differs from that of the imprint by
  /// more than a gel springs back, or most of them have moved apart by more than a gel stretches.
  bool are_renamed(const DotMotion& motion, const Point2<S>& imprint_px, State& state) const {
    const S limit = S(0.75 * test_.pitch_px);
    state.x_.clear();
    for_pairs(state, [&](const Point2<S>& key, const Point2<S>& now) {
      state.x_.push_back(norm(now - key - motion.shift));
    });
    return limit < norm(motion.shift - imprint_px) || limit < median(state.x_);
  }
  template <class Visit>
  void for_pairs(const State& state, const Visit& visit) const {
    for (std::size_t k = 0; k < state.dots_.size(); ++k) {
      if (is_finite(state.key_dots_[k]) && touches(state.dots_[k], state)) {
        visit(state.key_dots_[k], state.dots_[k]);
      }
    }
  }
  static S median(std::vector<S>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  static constexpr double filled = 0.95;
  Index rows_;
  Index cols_;
  Index dot_rows_;
  Index dot_cols_;
  SlideTest test_;
};

}  // namespace v0
}  // namespace fingerpad
