// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From a depth map to the contact region, with the library's contact_region.hpp; the only place of
// the program that knows it.
#include <functional>
#include <opencv2/core.hpp>

#include "fingerpad/contact/contact_region.hpp"
#include "replay/io/recording.hpp"
#include "replay/steps/depth_step.hpp"

namespace replay {

using fingerpad::ContactResult;
/// Writes 255 where a depth map is in contact, else 0.
using ContactStep =
    std::function<ContactResult(const cv::Mat_<float>& depth_mm, cv::Mat_<uchar>& mask)>;

/// The threshold comes from the recording's frames of the free pad, made into depths by
/// `depth_step`, or, where it has none, from the known shape of the free pad. Throws
/// fingerpad::parameter_error.
ContactStep make_contact_step(Recording& recording, const DepthStep& depth_step);

}  // namespace replay
