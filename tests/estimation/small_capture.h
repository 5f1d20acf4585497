// A small synthetic capture on disk, gone when it goes out of scope.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "estimation/search/discover.h"
#include "tests/support/temporary_folder.h"

namespace hookeye::test {

struct SmallCapture {
  std::string hidden = "";       ///< lines of `hidden:`; empty: nothing is hidden
  std::string told = "0.02";     ///< mu that the capture tells; the true one is 0.02
  std::string truth_mesh = "1";  ///< edge of the truth's mesh over the told one
  bool same_renderer = false;    ///< the truth's rays are those of the fit: noise alone is left
  unsigned seed = 5;             ///< of texture and noise
  /// Lines of `examples:` after the pull and the bend, before the poke that is held out.
  std::string loads = "  twist: {rotate: 20}\n";
  std::string recipe = "";  ///< another body: the whole recipe, instead of all above
};

/// Two cameras of 200 x 260 px; rest, pull, side, `loads`; poke held out. The truth is solved on
/// the told mesh unless said, so that what is missing is what was hidden.
class SmallScene {
 public:
  explicit SmallScene(const SmallCapture& capture);
  std::shared_ptr<const Scene> scene;

 private:
  TemporaryFolder folder_;
};

/// Lines of `hidden:`: the second camera is off from the start by so many of the deviations that
/// with_known_cameras() tells, in each number of its pose.
std::string knocked(double deviations);
/// The same capture, its cameras known to half a milliradian, a tenth of a millimetre across, 0.4
/// mm in distance and a thousandth of the focal length.
std::shared_ptr<const Scene> with_known_cameras(const Scene& scene);

/// The capture's own model, fitted; as a step, diagnosed too.
Fitted base_fit(Workspace& workspace);
Step base_step(Workspace& workspace);
/// A diagnosis of these effects, where a test asks for the scores of no other.
DiagnosisOptions of_alone(const std::vector<std::string>& effects);

/// Of one of its parameters; throws where it has none of that name.
double value_of(const Fitted& fitted, const std::string& name);

/// The whole search in it; throws where it fails.
Discovery discover(const SmallScene& small, const DiscoverOptions& options = {});

}  // namespace hookeye::test
