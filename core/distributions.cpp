#include "core/distributions.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace hookeye {

double student_quantile(double probability, double degrees) {
  return quantile(boost::math::students_t(degrees), probability);
}

double chi2_quantile(double probability, double degrees) {
  if (degrees == 0.0) return 0.0;
  return quantile(boost::math::chi_squared(degrees), probability);
}

}  // namespace hookeye
