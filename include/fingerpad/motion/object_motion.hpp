// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Motion of an object in contact, from the dots of the membrane in space. Source: Ito, Kim, Nagai,
// Obinata, "Acquisition of tactile information by vision-based tactile sensor for dexterous
// handling of robot hands", III.C; as printed in published/object_motion.hpp, docs/errata.md,
// E021-E024.
//
// While nothing slips, the dots in contact move with the object. A map holds their places on it, as
// they were when the object began. In each frame, the pose is the rigid motion that best fits the
// map to the dots. Then dots new in contact are entered with that pose, those that stay refine
// their entry as a running mean, and those that have left are removed. A patch of fifty dots has a
// tenth of the tilt noise of nine, and its memory is lost only when the contact has rolled over its
// whole width. Dots cannot show that an object slides as a whole, or that it is exchanged for
// another.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/math/rigid_fit.hpp"
#include "fingerpad/math/rotation.hpp"

namespace fingerpad {
inline namespace v1 {

enum class MotionStatus : std::uint8_t {
  ok,
  doubtful,  ///< a pose, but its residual exceeds the noise of the dots by 1.4: a soft object, dots
             ///< beside it, or slip that nobody has told
  no_contact,  ///< dots were found, but none is in contact: the object is gone
  /// The pose is not known: fewer than three known dots in contact (nine to begin an object), dots
  /// on a line or not in mm, a residual beyond a quarter of the pitch, or a grid of another size.
  no_pose,
  slipping,  ///< fewer than a fifth of the dots in contact stick, or no more than half since then
};
inline constexpr std::array<const char*, 5> motion_status_names = {"ok", "doubtful", "no contact",
                                                                   "no pose", "slipping"};
/// "ok", "doubtful", ...
constexpr const char* name_of(MotionStatus status) {
  return motion_status_names[static_cast<std::size_t>(status)];
}

namespace detail {

template <scalar S>
Pose<S> missing_pose() {
  const S none = not_a_number<S>();
  return {{{{none, none, none}, {none, none, none}, {none, none, none}}}, missing_point<S>()};
}

}  // namespace detail

/// Motion of the object in a frame. Without a pose, dots_used is 0 and all numbers of the motion
/// are NaN.
template <scalar S = double>
struct [[nodiscard]] ObjectMotionResult {
  MotionStatus status = MotionStatus::no_pose;
  Index object = 0;  ///< which object: 1 for the first, one more with each that begins; 0: none yet
  bool begun = false;   ///< it begins with this frame: the pose is the identity
  Index dots_used = 0;  ///< dots from which the pose was computed
  /// x_now = R x_first + t, from the frame in which the object began.
  Pose<S> pose = detail::missing_pose<S>();
  /// Of the pose, about z, y and x.
  Angles<S> angles = {not_a_number<S>(), not_a_number<S>(), not_a_number<S>()};
  Point3<S> position_mm =  ///< of the object's point that lay at the centroid of its first dots
      detail::missing_point<S>();
  Point3<S> displacement_mm = detail::missing_point<S>();  ///< of that point
  S residual_rms_mm = not_a_number<S>();  ///< rms distance of the dots used from the rigid motion
  /// Standard deviations of the position, as the length of its error, and of the angle between
  /// found and true rotation, since the object began; NaN without depth_noise_mm. The noise of a
  /// dot, or the residual if that is larger, is common to about four dots, as far as depth is
  /// smoothed; the rotation's is the residual and what smoothing does at a contact's edge. What
  /// dots that leave take with them adds up, and the further the position lies from the dots that
  /// touch now, the more the rotation moves it.
  S position_sd_mm = not_a_number<S>();
  S rotation_sd_rad = not_a_number<S>();

  bool has_pose() const { return status == MotionStatus::ok || status == MotionStatus::doubtful; }
  bool ok() const { return status == MotionStatus::ok; }
};

/// Pose of the object in contact, frame by frame. The object is the state: copy it to return to a
/// frame. A frame allocates nothing, throws nothing, and takes O(rows cols) time.
///
/// An object begins with nine dots in contact, and ends when no dot is in contact or when it
/// slides; what is touched then is a new object with the next number. After frames with contact but
/// without a pose the object is found again as soon as three of its dots are back.
template <scalar S = double>
class ObjectMotion {
 public:
  /// For a grid of rows x cols dots. Refuses bad parameters (parameter_error).
  ObjectMotion(Index rows, Index cols)
      : frame_{(expects_grid_size("ObjectMotion", rows, cols, 0), rows), cols},
        map_(frame_.found.size()),
        seen_(map_.size()) {}

  Index rows() const { return frame_.rows; }
  Index cols() const { return frame_.cols; }

  /// Processes a frame with the dots `dots_mm` (NaN, or not beyond the plate, z <= 0: not found),
  /// of which those with a true `contact` touch the object and those with a true `slips` do not
  /// stick to it, for instance by the stick ratio. Slipping dots are left out, and entered again
  /// where they stick again. If fewer than a fifth stick, the status is `slipping`, and a new
  /// object begins once more than half stick: it is not known how far the first one slid, and a
  /// smaller part that seems to stick is more likely carried along by a slide. `depth_noise_mm` is
  /// the standard deviation of a dot's depth, by far the largest of its errors; 0: the residual is
  /// not judged by it.
  template <spatial_dot_grid Dots, contact_mask Contact, contact_mask Slips>
  ObjectMotionResult<S> operator()(const Dots& dots_mm,
                                   const Contact& contact,
                                   const Slips& slips,
                                   double depth_noise_mm = 0) {
    const auto dots = as_view(dots_mm);
    const auto flags = as_view(contact);
    const auto slipping = as_view(slips);
    last_.begun = false;
    last_.dots_used = 0;
    last_.position_sd_mm = last_.rotation_sd_rad = not_a_number<S>();
    last_.status = MotionStatus::no_pose;
    if (dots.rows() != rows() || dots.cols() != cols() || !same_size(dots, flags) ||
        !same_size(dots, slipping)) {
      return without_pose();
    }
    frame_.read(dots);
    read(flags, slipping);
    last_.status = look(depth_noise_mm);
    estimate_errors(depth_noise_mm);
    return last_.has_pose() ? last_ : without_pose();
  }

  /// The same if no dot slips.
  template <spatial_dot_grid Dots, contact_mask Contact>
  ObjectMotionResult<S> operator()(const Dots& dots_mm, const Contact& contact) {
    return (*this)(dots_mm, contact, LazyView(rows(), cols(), [](Index, Index) { return false; }));
  }

 private:
  struct Entry {
    Point3<S> place_mm = {S(0), S(0), S(0)};
    S weight = S(0);    ///< of the mean; 0: not on the map
    bool left = false;  ///< found in this frame, but it does not stick
  };
  /// last_ keeps the pose, from which the next one follows.
  ObjectMotionResult<S> without_pose() const {
    ObjectMotionResult<S> result;
    result.status = last_.status;
    result.object = last_.object;
    return result;
  }
  /// Lists the dots that stick, and marks those that are found but do not; missing ones may still
  /// be in contact.
  template <class Contact, class Slips>
  void read(const Contact& contact, const Slips& slips) {
    known_ = fresh_ = flagged_ = found_ = touching_ = 0;
    for (Index i = 0; i < rows(); ++i) {
      for (Index j = 0, k = frame_.cell(i, 0); j < cols(); ++j, ++k) {
        const bool found = S(0) < frame_.found[k].z;
        const bool flagged = is_contact(cell_t<Contact>(contact(i, j)));
        const bool sticks = found && flagged && !is_contact(cell_t<Slips>(slips(i, j)));
        found_ += found ? 1 : 0;
        flagged_ += flagged ? 1 : 0;
        touching_ += found && flagged ? 1 : 0;
        map_[k].left = found && !sticks;
        if (sticks) {
          const bool known = S(0) < map_[k].weight;
          seen_[known ? known_++ : seen_.size() - ++fresh_] = k;
        }
      }
    }
  }
  std::span<const Index> known() const { return std::span(seen_).first(known_); }
  std::span<const Index> fresh() const { return std::span(seen_).last(fresh_); }

  MotionStatus look(double depth_noise_mm) {
    if (flagged_ == 0) {
      if (found_ > 0) {
        end();
        has_slid_ = false;
      }
      return found_ > 0 ? MotionStatus::no_contact : MotionStatus::no_pose;
    }
    const std::size_t sticking = known_ + fresh_;
    if (5 * sticking < touching_ || (has_slid_ && touching_ > 0 && 2 * sticking <= touching_)) {
      end();
      has_slid_ = true;
      return MotionStatus::slipping;
    }
    if (!(has_object_ ? advance() : begin())) {
      return MotionStatus::no_pose;
    }
    const bool doubted = depth_noise_mm > 0 && S(1.4 * depth_noise_mm) < last_.residual_rms_mm;
    return doubted ? MotionStatus::doubtful : MotionStatus::ok;
  }

  /// Variance of the pose's angle per variance of a dot's depth: that of a plane through them, and
  /// of its height in their middle. The memory of the pose is worth as much when the object begins,
  /// and loses with each share of new dots, which are entered with the pose of their frame.
  void estimate_errors(double depth_noise_mm) {
    using std::sqrt;
    if (!last_.has_pose() || !(depth_noise_mm > 0)) {
      return;
    }
    const auto used = last_.begun ? fresh() : known();
    Point3<S> middle = {S(0), S(0), S(0)};
    S spread_sq = S(0);
    const S count = S(static_cast<double>(used.size()));
    for (const Index k : used) {
      middle += frame_.found[k] / count;
    }
    for (const Index k : used) {
      spread_sq = spread_sq + squared_norm(frame_.found[k] - middle);
    }
    constexpr double common = 4;  // dots with one error
    const S tilt = S(4 * common) / spread_sq, shift = S(common) / count;
    const S renewed = S(static_cast<double>(fresh_)) / S(static_cast<double>(known_ + fresh_));
    memory_ = last_.begun ? tilt : memory_ + renewed * tilt;
    shift_memory_ = last_.begun ? shift : shift_memory_ + renewed * shift;
    const S noise =
        S(depth_noise_mm) < last_.residual_rms_mm ? last_.residual_rms_mm : S(depth_noise_mm);
    const S seen_sq = square(last_.residual_rms_mm) * count / (count - S(2));  // six are fitted
    const S tilt_sq = seen_sq + S(square(bias_mm));
    last_.rotation_sd_rad = last_.begun ? S(0) : sqrt(tilt_sq * (memory_ + tilt));
    const S lever_sq = squared_norm(last_.position_mm - middle);
    last_.position_sd_mm = sqrt(square(noise) * (shift_memory_ + shift) +
                                lever_sq / S(2) * square(last_.rotation_sd_rad));
  }

  void end() {
    has_object_ = false;
    std::fill(map_.begin(), map_.end(), Entry());
  }

  template <class From, class Weight>
  std::optional<Pose<S>> fit(std::span<const Index> dots,
                             const From& from,
                             const Weight& weight) const {
    const auto cell = [&](Index n) { return dots[static_cast<std::size_t>(n)]; };
    return fit_rigid<S>(
        static_cast<Index>(dots.size()), [&](Index n) { return from(cell(n)); },
        [&](Index n) { return frame_.found[cell(n)]; }, [&](Index n) { return weight(cell(n)); });
  }

  bool begin() {
    const auto itself = [this](Index k) { return frame_.found[k]; };
    if (fresh_ < 9 || !fit(fresh(), itself, [](Index) { return S(1); })) {
      return false;
    }
    Point3<S> sum = {S(0), S(0), S(0)};
    for (const Index k : fresh()) {
      sum += frame_.found[k];
    }
    pitch_sq_ = detail::mean_pitch_sq(fresh(), frame_.found.data(), frame_.width);
    pitch_sq_ = S(0) < pitch_sq_ ? pitch_sq_ : S(square(49.0));  // no neighbours
    if (!(S(square(0.05)) < pitch_sq_ && pitch_sq_ < S(square(50.0)))) {
      return false;  // dots in m or um
    }
    start_mm_ = sum / S(static_cast<double>(fresh_));
    const Index object = last_.object + 1;
    last_ = {};
    last_.object = object;
    last_.begun = has_object_ = true;
    last_.dots_used = static_cast<Index>(fresh_);
    last_.pose = {};
    last_.angles = {};
    last_.position_mm = start_mm_;
    last_.displacement_mm = {S(0), S(0), S(0)};
    last_.residual_rms_mm = S(0);
    has_slid_ = false;
    enter();
    return true;
  }

  bool advance() {
    using std::sqrt;
    const std::optional<Pose<S>> found = fit(
        known(), [this](Index k) { return map_[k].place_mm; },
        [this](Index k) {  // by the noise of the entry and of the dot
          return map_[k].weight / (map_[k].weight + S(1));
        });
    if (known_ < 3 || !found) {
      return false;
    }
    S sum_sq = S(0);
    for (const Index k : known()) {
      sum_sq = sum_sq + squared_norm(frame_.found[k] - (*found)(map_[k].place_mm));
    }
    const S mean_sq = sum_sq / S(static_cast<double>(known_));
    // no membrane turns by 2.5 rad between two poses: exchanged rows and columns turn a patch over
    if (pitch_sq_ < S(16) * mean_sq ||
        S(2.5) < angle_between(last_.pose.rotation, found->rotation)) {
      return false;
    }
    last_.dots_used = static_cast<Index>(known_);
    last_.pose = *found;
    last_.angles = zyx_angles(found->rotation);
    last_.position_mm = (*found)(start_mm_);
    last_.displacement_mm = last_.position_mm - start_mm_;
    last_.residual_rms_mm = S(0) < mean_sq ? sqrt(mean_sq) : S(0);
    for (Entry& entry : map_) {
      entry.weight = entry.left ? S(0) : entry.weight;
    }
    const Pose<S> back = inverse(*found);
    for (const Index k : known()) {
      Entry& entry = map_[k];
      entry.weight = entry.weight + S(1);
      entry.place_mm += (back(frame_.found[k]) - entry.place_mm) / entry.weight;
    }
    enter();
    return true;
  }

  /// A new entry has the error of the pose besides that of its dot: it counts as half a dot.
  void enter() {
    const Pose<S> back = inverse(last_.pose);
    for (const Index k : fresh()) {
      map_[k] = {back(frame_.found[k]), S(1) / S(2)};
    }
  }

  /// What smoothing moves the depth by, at most, inside the edge of a plate or a ball; a rigid
  /// motion follows it, so that the residual does not show it.
  static constexpr double bias_mm = 0.009;

  detail::FrameOfDots<S> frame_;
  detail::Bordered<Entry> map_;  ///< by the cells of the frame
  std::vector<Index> seen_;      ///< dots that stick: known ones first, new ones from the back
  std::size_t known_ = 0, fresh_ = 0;  ///< how many
  std::size_t flagged_ = 0, found_ = 0, touching_ = 0;
  bool has_object_ = false;
  bool has_slid_ = false;  ///< and no object has begun since
  S memory_ = S(0);        ///< variance of the map's angle per variance of a dot's depth, 1/mm^2
  S shift_memory_ = S(0);  ///< and of its height
  S pitch_sq_ = S(0);      ///< mean square distance of neighbours when the object began, mm^2
  Point3<S> start_mm_ = {S(0), S(0), S(0)};
  ObjectMotionResult<S> last_;
};

}  // namespace v1
}  // namespace fingerpad
