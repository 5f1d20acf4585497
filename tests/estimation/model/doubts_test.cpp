// What can be computed but is most likely not what the user meant.
#include "estimation/model/doubts.h"

#include <gmock/gmock.h>

#include "tests/estimation/effects_scene.h"

namespace hookeye::test {
namespace {

/// A load on a region that holds a corner of the body and no face acts on one node.
TEST(Doubts, ARegionWithoutAreaIsTold) {
  EXPECT_THAT(doubts(*block_scene()),
              testing::Not(testing::Contains(testing::HasSubstr("no area"))));
  Scene scene = *block_scene();
  auto body = std::make_shared<Body>(*scene.body);
  const Vector3d corner = body->mesh.X.rowwise().maxCoeff();
  for (RegionSpec& spec : scene.capture.regions)
    if (spec.name == "grip")
      spec.shape =
          RegionSpec::Box{corner - Vector3d::Constant(1e-6), corner + Vector3d::Constant(1e-6)};
  body->regions = RegionSet(scene.capture, body->mesh, nullptr);
  scene.body = body;
  EXPECT_THAT(doubts(scene), testing::Contains(testing::AllOf(
                                 testing::HasSubstr("region `grip` of a "),
                                 testing::HasSubstr(" has 1 node and no area"),
                                 testing::HasSubstr("`halfspace: {point: [x, y, z]"))));
}

}  // namespace
}  // namespace hookeye::test
