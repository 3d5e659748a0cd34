// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// OpenCV images as grids: cv::Mat_<T> directly, and one channel of an interleaved cv::Mat as a view
// without a copy. A cv::Mat knows its type only at run time, so the caller names the type.
#include <opencv2/core/mat.hpp>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v1 {

template <class T>
struct grid_traits<cv::Mat_<T>> {
  using Image = cv::Mat_<T>;
  static Index rows(const Image& m) { return m.rows; }
  static Index cols(const Image& m) { return m.cols; }
  // A padded row is a whole number of values, but not always of pixels. Only images of one channel
  // therefore have a stride.
  static constexpr bool has_stride = cv::DataType<T>::channels == 1;
  static const T& at(const Image& m, Index i, Index j) {
    return m.template ptr<T>(static_cast<int>(i))[j];
  }
  static T& at(Image& m, Index i, Index j) { return m.template ptr<T>(static_cast<int>(i))[j]; }
  static const T* data(const Image& m) requires(has_stride) { return m.template ptr<T>(); }
  static T* data(Image& m) requires(has_stride) { return m.template ptr<T>(); }
  static Index row_stride(const Image& m) { return static_cast<Index>(m.step[0] / sizeof(T)); }
  static Index col_stride(const Image&) { return 1; }
};

/// Rejects an untyped cv::Mat with a readable message.
template <std::same_as<cv::Mat> M>
struct grid_traits<M> {
  static_assert(!std::same_as<M, cv::Mat>,
                "the type of the pixels of a cv::Mat is not known: pass cv::Mat_<T>(image), or "
                "fingerpad::channel<T>(image, c) of a colour image");
};

/// A view of channel `c` of `image` (B = 0, G = 1, R = 2 as OpenCV reads colour files). T must be
/// the type of its values. Refuses an empty image, another type and a missing channel
/// (parameter_error). The image must outlive the view.
template <class T>
StridedView<T> channel(cv::Mat& image, int c) {
  expects(!image.empty(), "channel", "pixels of the image", static_cast<long long>(image.total()),
          "> 0: was the image read?");
  expects(image.depth() == cv::DataType<std::remove_const_t<T>>::depth, "channel", "image.depth()",
          static_cast<long long>(image.depth()), "the depth of the requested type");
  expects(c >= 0 && c < image.channels(), "channel", "c", static_cast<long long>(c),
          "in [0, image.channels())");
  return interleaved_channel(image.ptr<T>(), image.rows, image.cols, image.channels(), c,
                             static_cast<Index>(image.step[0] / sizeof(T)));
}
template <class T>
StridedView<const T> channel(const cv::Mat& image, int c) {
  return channel<const T>(const_cast<cv::Mat&>(image), c);
}

}  // namespace v1
}  // namespace fingerpad
