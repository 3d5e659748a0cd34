/* SPDX-FileCopyrightText: 2026 The fingerpad authors
   SPDX-License-Identifier: MIT */
#pragma once
// What the page calls. All memory belongs to the core and stays where it is until the next
// pad_start() or own_start(); images are rows of red, green, blue, opaque.

#ifdef __cplusplus
extern "C" {
#endif

// The virtual pad: pad_size_px() x pad_size_px() pixels, pad_dots_across()^2 printed dots.
void pad_start(void);
// One frame: the object as it is now, sd of the camera's noise, and when, s. Press 0: lifted.
void pad_frame(int is_ball,
               double x_mm,
               double y_mm,
               double turn_rad,
               double press_mm,
               double friction,
               double noise_levels,
               double time_s);
// The same of a scene of eight seconds: pressed, turned, dragged until it slides, dragged back,
// lifted.
void pad_demo_frame(double time_s, int is_ball, double noise_levels);
int pad_size_px(void);
int pad_dots_across(void);
const unsigned char* pad_image(void);
const float* pad_depth_mm(void);  // measured; NaN outside of the pad
const float* pad_true_depth_mm(void);
const unsigned char* pad_touching(void);  // measured contact: 255, else 0
const float* pad_dots(void);              // of each dot x, y, z in mm, touches, state (DotState)
const float* pad_section(void);  // of each pixel of the middle row x, depth, true depth in mm
int pad_edge_count(void);
const float* pad_edge(void);  // x, y in mm of each outermost pixel in contact
const double* pad_numbers(void);
const char* pad_names(void);  // of the numbers, in their order, with commas between them

// One's own free and pressed picture: write both, then measure.
void own_start(int rows, int cols);
unsigned char* own_free_image(void);
unsigned char* own_pressed_image(void);
void own_measure(double pitch_mm, double base_radius_mm, double height_mm);
const float* own_depth_mm(void);
const unsigned char* own_touching(void);
const double* own_numbers(void);
const char* own_names(void);

// Why the last parameter was refused, after which the instance is of no more use.
const char* refusal_text(void);

#ifdef __cplusplus
}
#endif
