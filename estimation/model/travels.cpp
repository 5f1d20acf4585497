#include "estimation/model/travels.h"

#include <fmt/format.h>

#include <algorithm>

#include "capture_io/travel.h"

namespace hookeye {
namespace {

class Travels final : public Ingredient {
 public:
  struct Slot {
    int example;
    std::string example_name, region;
    Vector3d along;  ///< unit vector, in the body's frame
    double sigma;    ///< [length]
  };
  Travels(std::vector<Slot> slots, std::string length)
      : slots_(std::move(slots)), length_(std::move(length)) {}
  std::string name() const override { return "travel"; }
  std::vector<Parameter> parameters() const override {
    // Beyond that the measurement speaks of another travel than the support.
    constexpr double kMost = 6.0;
    std::vector<Parameter> all;
    for (const Slot& slot : slots_) {
      Parameter parameter;
      parameter.name = fmt::format("{}.{}.travel", slot.example_name, slot.region);
      parameter.unit = length_;
      parameter.long_name = fmt::format("travel of '{}' in '{}' beyond the prescribed one",
                                        slot.region, slot.example_name);
      parameter.low = -kMost * slot.sigma, parameter.high = kMost * slot.sigma;
      parameter.typical = slot.sigma;
      parameter.example = slot.example;
      all.push_back(std::move(parameter));
    }
    return all;
  }
  Touches touches() const override { return {.loading = true}; }

  void apply(const VectorXd& values, Model& model) const override {
    for (size_t s = 0; s < slots_.size(); ++s) {
      const auto& nodes = model.scene->body->regions.at(slots_[s].region).nodes;
      const Vector3d more = values[static_cast<Eigen::Index>(s)] * slots_[s].along;
      Loading& loading = model.examples[static_cast<size_t>(slots_[s].example)].loading;
      for (size_t i = 0; i < loading.prescribed.size(); ++i)
        if (std::ranges::binary_search(nodes, loading.prescribed[i] / 3))
          loading.displacement[static_cast<Eigen::Index>(i)] += more[loading.prescribed[i] % 3];
    }
  }

 private:
  std::vector<Slot> slots_;
  std::string length_;
};

/// The measurement of a support's travel, in its direction; null: there is none.
const MeasuredSpec* measurement_of(const SupportSpec& support, const Vector3d& along,
                                   const ExampleSpec& example) {
  constexpr double kSameDirection = 0.9999;  // cosine
  for (const MeasuredSpec& measured : example.measured)
    if (measured.kind == MeasuredSpec::Kind::travel_of && measured.region == support.region &&
        std::abs(measured.direction.dot(along)) > kSameDirection)
      return &measured;
  return nullptr;
}

}  // namespace

std::shared_ptr<const Ingredient> travel_ingredient(const Scene& scene) {
  std::vector<Travels::Slot> slots;
  for (size_t e = 0; e < scene.capture.examples.size(); ++e) {
    const ExampleSpec& example = scene.capture.examples[e];
    for (const SupportSpec& support : example.supports) {
      const Vector3d travel = prescribed_travel(support);
      if (travel.isZero(0.0) || support.rigid.degrees != 0.0) continue;
      const Vector3d along = travel.normalized();
      if (const MeasuredSpec* measured = measurement_of(support, along, example))
        slots.push_back(
            {static_cast<int>(e), example.name, support.region, along, measured->sigma[0]});
    }
  }
  if (slots.empty()) return nullptr;
  return std::make_shared<Travels>(std::move(slots), scene.capture.units.length);
}

}  // namespace hookeye
