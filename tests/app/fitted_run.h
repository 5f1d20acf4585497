// A small run made by the program itself, in seconds.
#pragma once

#include "app/cli.h"

namespace hookeye::test {

inline constexpr const char* kSmallRecipe = R"(hookeye_recipe: 1
title: small
seed: 3
body: {shape: block, size: [20, 20, 40], mesh: {edge: 10, order: 1}, density: 1.07e-9}
material: {law: neo-hookean, true: {mu: 0.05, kappa_over_mu: 12}, told: {mu: 0.042}, fit: [mu]}
cameras: {count: 1, size: [120, 120], focal: 400}
examples:
  rest: {}
  pull: {force: [0, 0, 0.4]}
  push: {use: validate, force: [0.1, 0, 0]}
hidden:
  - {effect: gravity, values: {gravity.x: 3000, gravity.z: -9650}}
)";

/// A capture that hides gravity.
class WithSmallCapture : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    photograph(kSmallRecipe);
  }
};

/// And the base model fitted to it.
class FittedRun : public WithSmallCapture {
 protected:
  void SetUp() override {
    WithSmallCapture::SetUp();
    const Result fitted = hookeye("fit capture -o run");
    ASSERT_EQ(fitted.status, 0) << fitted.err;
  }
  json timeline() const { return json::parse(read(folder_ / "run/run.json")); }
};

}  // namespace hookeye::test
