#include "core/helper.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <thread>

#include "core/interrupted.h"
#include "core/wire.h"

namespace hookeye {
namespace {

using ::testing::HasSubstr;
using Doubles = std::vector<double>;

TEST(Wire, ValuesComeBackInOrder) {
  const std::map<std::string, std::vector<int>> groups = {{"a", {1, 2}}, {"", {}}};
  const Eigen::MatrixXi matrix = Eigen::MatrixXi::Random(4, 7);
  const std::string bytes = Packer()
                                .put(3)
                                .put("text")
                                .put(Doubles{1.5, -2})
                                .put(std::vector<std::string>{"x", ""})
                                .put(matrix)
                                .put(groups)
                                .put(true)
                                .take();
  Unpacker from(bytes);
  EXPECT_EQ(from.take<int>(), 3);
  EXPECT_EQ(from.take<std::string>(), "text");
  EXPECT_EQ(from.take<Doubles>(), (Doubles{1.5, -2}));
  EXPECT_EQ(from.take<std::vector<std::string>>(), (std::vector<std::string>{"x", ""}));
  EXPECT_EQ(from.take<Eigen::MatrixXi>(), matrix);
  EXPECT_EQ((from.take<std::map<std::string, std::vector<int>>>()), groups);
  EXPECT_THROW(from.end(), WireFault);
  EXPECT_TRUE(from.take<bool>());
  EXPECT_NO_THROW(from.end());
}

TEST(Wire, CountsAreNotBelieved) {
  for (const uint64_t count : {uint64_t{3}, uint64_t{1} << 32, uint64_t{1} << 61, ~uint64_t{0}}) {
    const std::string bytes = Packer().put(count).put(count).put(1.0).take();
    EXPECT_THROW(Unpacker(bytes).take<Doubles>(), WireFault) << count;
    EXPECT_THROW(Unpacker(bytes).take<Eigen::MatrixXd>(), WireFault) << count;
    EXPECT_THROW(Unpacker(bytes).take<std::vector<std::string>>(), WireFault) << count;
  }
  EXPECT_THROW(Unpacker("abc").take<int>(), WireFault);
  const std::string wide = Packer().put(uint64_t{4}).put(uint64_t{0}).take();
  EXPECT_THROW(Unpacker(wide).take<Eigen::Matrix3Xd>(), WireFault) << "four rows are not three";
}

/// Asks a helper that does what libraries do with damaged files (tests/helpers/faulty.cpp).
class Helpers : public testing::Test {
 protected:
  void SetUp() override {
    real_ = helper_folder().string();
    ::setenv("HOOKEYE_LIBEXEC", HOOKEYE_TEST_HELPERS, 1);
  }
  void TearDown() override { ::unsetenv("HOOKEYE_LIBEXEC"); }

  static HelperRequest request(const std::string& task) {
    return {.name = "faulty",
            .content = Packer().put(task).put(Doubles(1000, 0.25)).take(),
            .limits = {64.0 * (1 << 20), 1.0},
            .place = {"capture.yaml", 5, 3},
            .right = "a whole file",
            .damaged = "the file is damaged"};
  }
  static std::string ask(const std::string& task) {
    return ask_helper(request(task), [](Unpacker& from) {
      auto echo = from.take<std::string>();
      EXPECT_EQ(from.take<Doubles>(), Doubles(1000, 0.25));
      return echo;
    });
  }
  /// What the InputError says.
  static std::string refusal(const std::string& task) {
    try {
      ask(task);
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was refused";
  }
  std::string real_;
};

TEST_F(Helpers, WhateverEndsOneIsAnErrorOfTheInputAndTheNextRequestWorks) {
  const std::pair<const char*, const char*> cases[] = {
      {"crash", "capture.yaml:5:3: the file is damaged\n  a whole file"},
      {"abort", "capture.yaml:5:3: the file is damaged\n  a whole file"},
      {"exit", "capture.yaml:5:3: the file is damaged\n  a whole file"},
      {"nonsense", "capture.yaml:5:3: the file is damaged\n  a whole file"},
      {"eat", "capture.yaml:5:3: reading this file takes too much memory\n  a whole file"},
      {"kill", "capture.yaml:5:3: reading this file takes too much memory\n  a whole file"},
      {"spin", "capture.yaml:5:3: reading this file takes too long\n  a whole file"},
      {"refuse", "a.vtu:3:4: it is wrong\n  be right"}};
  for (const auto& [task, told] : cases) {
    EXPECT_EQ(refusal(task), told) << task;
    EXPECT_EQ(ask("echo"), "echo") << "after " << task;
  }
}

TEST_F(Helpers, WhoAsksMayLearnHowOneDied) {
  const auto death_of = [](const std::string& task) {
    try {
      ask(task);
    } catch (const HelperDied& died) {
      return died;
    }
    throw std::runtime_error(task + " did not die");
  };
  const HelperDied aborted = death_of("abort"), spun = death_of("spin");
  EXPECT_TRUE(aborted.within_limits());
  EXPECT_LT(aborted.seconds(), 0.9);
  EXPECT_FALSE(spun.within_limits());
  EXPECT_NEAR(spun.seconds(), 1.5, 0.6) << "limits are whole seconds";
  EXPECT_FALSE(death_of("kill").within_limits());
  EXPECT_FALSE(death_of("eat").within_limits());
}

TEST_F(Helpers, CtrlCEndsTheOneThatAsksForItAndNoOther) {
  EXPECT_EQ(ask("masked"), "masked");
  EXPECT_THROW(ask("interrupted"), Interrupted);
  EXPECT_EQ(ask("echo"), "echo");
}

TEST_F(Helpers, WhatIsNoFaultOfTheFileIsNotToldAsOne) {
  EXPECT_THROW(ask("throw"), std::runtime_error);
  EXPECT_EQ(refusal("echo"), "nothing was refused");
  HelperRequest unknown = request("echo");
  unknown.name = "nowhere";
  try {
    ask_helper(unknown, [](Unpacker& from) { return from.take<int>(); });
    FAIL();
  } catch (const InputError&) {
    FAIL() << "a missing program is no fault of the file";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("nowhere cannot be started"));
  }
}

TEST_F(Helpers, ThreadsMayAskAtOnce) {
  std::vector<std::thread> all;
  std::atomic<int> right = 0;
  for (int t = 0; t < 8; ++t)
    all.emplace_back([&right] {
      for (int i = 0; i < 20; ++i) right += ask("echo") == "echo";
    });
  for (std::thread& one : all) one.join();
  EXPECT_EQ(right, 160);
}

/// Ctrl-C that reaches the program alone, as by `kill -INT`.
TEST_F(Helpers, AnInterruptEndsThoseThatComputeForLong) {
  HelperRequest wanted = request("compute");
  wanted.limits = unlimited;
  wanted.interruptible = true;
  const auto ask_it = [&] { ask_helper(wanted, [](Unpacker& from) { return from.take<int>(); }); };
  std::thread ctrl_c([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    interrupt_helpers();
  });
  const auto began = std::chrono::steady_clock::now();
  EXPECT_THROW(ask_it(), Interrupted);
  ctrl_c.join();
  EXPECT_THROW(ask_it(), Interrupted) << "nothing long is begun any more";
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(5));
  EXPECT_EQ(ask("echo"), "echo") << "what writes goes on";
}

/// 160 MB there and back: neither side waits for the other to read.
TEST_F(Helpers, LargeMessagesPass) {
  HelperRequest wanted = request("echo");
  const Doubles many(size_t{20} << 20, 0.5);
  wanted.limits = unlimited;
  wanted.content = Packer().put("echo").put(many).take();
  const bool same = ask_helper(wanted, [&](Unpacker& from) {
    from.take<std::string>();
    return from.take<Doubles>() == many;
  });
  EXPECT_TRUE(same);
}

TEST_F(Helpers, FoundBesideTheProgram) {
  EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(real_) / "pictures")) << real_;
  EXPECT_EQ(helper_folder(), HOOKEYE_TEST_HELPERS);
}

}  // namespace
}  // namespace hookeye
