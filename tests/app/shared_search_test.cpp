// Questions shared by processes: each is answered once, whoever comes first, and what was left is
// taken up.
#include "runs/shared_search.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "app/cli.h"
#include "estimation/fit/archive.h"

namespace hookeye::test {
namespace {

class SharedSearchTest : public Cli {
 protected:
  /// One that works in the folder, as a process would.
  struct Worker {
    explicit Worker(const fs::path& folder)
        : shared(std::make_shared<SharedSearch>(folder, fs::path(),
                                                SharedSearch::Options{"a capture", 1})),
          archive(std::make_unique<Journal>(shared->own_journal(), "a capture")) {
      archive.share(shared, false);
    }
    std::shared_ptr<SharedSearch> shared;
    Archive archive;
  };
  static Question question(int which) { return {"fit", "a form", {1.0 + which, 0.5}, "from rest"}; }
  fs::path folder() const { return folder_ / "workers"; }
};

TEST_F(SharedSearchTest, EachQuestionIsAnsweredOnce) {
  constexpr int kQuestions = 100, kWorkers = 3;
  std::vector<std::unique_ptr<Worker>> workers;
  for (int w = 0; w < kWorkers; ++w) workers.push_back(std::make_unique<Worker>(folder()));
  std::atomic<int> worked{0};
  std::array<std::vector<double>, kWorkers> answers;
  std::vector<std::thread> threads;
  for (int w = 0; w < kWorkers; ++w)
    threads.emplace_back([&, w] {
      std::vector<int> order(kQuestions);
      for (int i = 0; i < kQuestions; ++i) order[static_cast<size_t>(i)] = i;
      std::shuffle(order.begin(), order.end(), std::mt19937(static_cast<unsigned>(w)));
      answers[static_cast<size_t>(w)].resize(kQuestions);
      for (const int i : order) {
        Archive& archive = workers[static_cast<size_t>(w)]->archive;
        json answer;
        if (!archive.find(question(i), answer)) {
          answer = 1000.0 * i + w;
          ++worked;
          archive.keep(question(i), answer);
        }
        answers[static_cast<size_t>(w)][static_cast<size_t>(i)] = answer;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(worked, kQuestions);
  EXPECT_EQ(answers[1], answers[0]);
  EXPECT_EQ(answers[2], answers[0]);
}

TEST_F(SharedSearchTest, WhatIsLeftIsTheNextOnesTurn) {
  Worker first(folder()), second(folder());
  json answer;
  ASSERT_FALSE(first.archive.find(question(1), answer));
  EXPECT_FALSE(second.shared->claim(Archive::key_of(question(1)))) << "somebody is at it";
  first.archive.leave(question(1));
  ASSERT_FALSE(second.archive.find(question(1), answer));
  second.archive.keep(question(1), 7.0);
  ASSERT_TRUE(first.archive.find(question(1), answer));
  EXPECT_EQ(answer, 7.0);
}

TEST_F(SharedSearchTest, WhatOthersAnsweredCountsInEveryBit) {
  Worker first(folder()), second(folder());
  json answer;
  ASSERT_FALSE(first.archive.find(question(1), answer));
  first.archive.keep(question(1), 7.0);
  Question near = question(1);
  near.numbers[0] += 1e-12;
  EXPECT_TRUE(first.archive.find(near, answer)) << "its own counts to rounding";
  EXPECT_FALSE(second.archive.find(near, answer));
  second.archive.leave(near);
  Question elsewhere = question(1);
  elsewhere.from = "another equilibrium";
  EXPECT_FALSE(second.archive.find(elsewhere, answer));
  second.archive.leave(elsewhere);
  EXPECT_TRUE(second.archive.find(question(1), answer));
  EXPECT_TRUE(second.archive.find(near, answer)) << "now it had its turn here, too";
  // What is done ahead is forgotten as one's own, and known in every bit.
  Worker third(folder());
  {
    const Archive::Ahead ahead(third.archive);
    EXPECT_FALSE(third.archive.may_go_ahead());
    EXPECT_TRUE(third.archive.find(question(1), answer));
    EXPECT_TRUE(third.archive.find(near, answer));
  }
  EXPECT_TRUE(third.archive.may_go_ahead());
  EXPECT_FALSE(third.archive.find(near, answer));
  third.archive.leave(near);
  EXPECT_TRUE(third.archive.find(question(1), answer));
}

TEST_F(SharedSearchTest, TheFolderGoesWithTheLast) {
  auto first = std::make_unique<Worker>(folder());
  auto second = std::make_unique<Worker>(folder());
  first.reset();
  remove_workers_folder(folder());
  EXPECT_TRUE(fs::exists(folder())) << "somebody is in it";
  second.reset();
  remove_workers_folder(folder());
  EXPECT_FALSE(fs::exists(folder()));
}

}  // namespace
}  // namespace hookeye::test
