// One value of many captures, each with its interval: a plot for the page.
#pragma once

#include <string>
#include <vector>

namespace hookeye {

struct StripPoint {
  double value = 0.0, low = 0.0, high = 0.0;  ///< low and high equal the value: no interval
  std::string label, link;                    ///< link: relative to the page; "": none
  bool explained = true;                      ///< its model explains the photos
  bool outlier = false;                       ///< set by mark_outliers()
};

/// Far from the median: by more than 3.5 times the spread of the others (1.4826 times the median
/// deviation, which is sigma for a normal distribution) and of its own interval. Fewer than five
/// tell no spread.
void mark_outliers(std::vector<StripPoint>& points);

double median_of(std::vector<double> values);

/// SVG: a row a capture, sorted by value, with the median. Text is 11 px high whatever the width.
std::string strip_plot(std::vector<StripPoint> points, const std::string& unit);

}  // namespace hookeye
