// A task's ticket is in one place at any moment, whoever moves it and whenever that is cut short.
#include "batch/batch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "core/input_error.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;
using testing::SizeIs;
namespace fs = std::filesystem;

const BatchOrder kOrder{"check", {"--quick"}, "xxh3:1", "0.0", false};

BatchTask task_of(int number) {
  return {fmt::format("{:032x}", number), fmt::format("capture {}", number), "/nowhere", {}, ""};
}

std::vector<Ticket> all_of(const BatchFolder& folder) {
  std::vector<Ticket> out;
  for (const TicketPlace place :
       {TicketPlace::todo, TicketPlace::leased, TicketPlace::done, TicketPlace::failed})
    for (const Ticket& one : folder.tickets().at(place)) out.push_back(one);
  return out;
}

TEST(TicketName, SaysKeyTriesAndWorker) {
  EXPECT_EQ((Ticket{"a1", 0, ""}.name()), "a1.0");
  EXPECT_EQ((Ticket{"a1", 2, "host-1-ff"}.name()), "a1.2@host-1-ff");
}

TEST(Tickets, AreEnrolledOnceByAnyNumber) {
  const TemporaryFolder place;
  const BatchFolder folder = BatchFolder::make(place / "batch", kOrder);
  constexpr int kTasks = 50;
  std::atomic<int> won = 0;
  std::vector<std::thread> enrolling;
  for (int t = 0; t < 4; ++t)
    enrolling.emplace_back([&, t] {
      for (int i = 0; i < kTasks; ++i) won += folder.enrol(task_of(i), fmt::format("w{}", t));
    });
  for (std::thread& one : enrolling) one.join();
  EXPECT_EQ(won, kTasks);
  EXPECT_THAT(folder.tickets().at(TicketPlace::todo), SizeIs(kTasks));
  EXPECT_TRUE(fs::is_empty(place / "batch/new"));
  EXPECT_EQ(folder.tasks()[7].label, "capture 15");  // by label
}

TEST(Tickets, GoToOneOfThoseWhoTry) {
  const TemporaryFolder place;
  const BatchFolder folder = BatchFolder::make(place / "batch", kOrder);
  constexpr int kTasks = 200, kWorkers = 4;
  for (int i = 0; i < kTasks; ++i) folder.enrol(task_of(i), "w");
  std::vector<int> got(kWorkers, 0);
  std::vector<std::thread> workers;
  for (int w = 0; w < kWorkers; ++w)
    workers.emplace_back([&, w] {
      for (const Ticket& one : folder.tickets().at(TicketPlace::todo))
        got[w] += folder.tickets().move(one, TicketPlace::todo, {one.key, 0, fmt::format("w{}", w)},
                                        TicketPlace::leased);
    });
  for (std::thread& one : workers) one.join();
  EXPECT_EQ(got[0] + got[1] + got[2] + got[3], kTasks);
  EXPECT_THAT(folder.tickets().at(TicketPlace::leased), SizeIs(kTasks));
  EXPECT_THAT(all_of(folder), SizeIs(kTasks));
}

TEST(Tickets, ALeaseThatIsAnothersCannotBeGivenBack) {
  const TemporaryFolder place;
  const BatchFolder folder = BatchFolder::make(place / "batch", kOrder);
  folder.enrol(task_of(1), "w");
  const Ticket waiting = folder.tickets().at(TicketPlace::todo).at(0), mine{waiting.key, 0, "mine"},
               yours{waiting.key, 0, "yours"};
  ASSERT_TRUE(folder.tickets().move(waiting, TicketPlace::todo, mine, TicketPlace::leased));
  ASSERT_TRUE(folder.tickets().move(mine, TicketPlace::leased, yours, TicketPlace::leased));
  EXPECT_FALSE(folder.tickets().move(mine, TicketPlace::leased, mine, TicketPlace::done));
  EXPECT_TRUE(folder.tickets().move(yours, TicketPlace::leased, yours, TicketPlace::done));
  // What a network file system repeats has happened.
  EXPECT_TRUE(folder.tickets().move(yours, TicketPlace::leased, yours, TicketPlace::done));
  EXPECT_THAT(all_of(folder), SizeIs(1));
}

TEST(Tickets, AnEnrollingThatWasCutShortIsFinished) {
  const TemporaryFolder place;
  const BatchFolder folder = BatchFolder::make(place / "batch", kOrder);
  const auto told = [](const std::string& by) {
    nlohmann::json out = to_json(task_of(1));
    out["enrolled_by"] = by;
    return out.dump();
  };
  const std::string key = task_of(1).key;
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(place / ("batch/" + name)) << text;
  };
  // Before the task was made: nothing was promised.
  write("new/" + key + ".0@early", told("early"));
  folder.tickets().finish_enrolling([](const std::string&) { return false; });
  EXPECT_TRUE(fs::exists(place / ("batch/new/" + key + ".0@early")));
  folder.tickets().finish_enrolling([](const std::string&) { return true; });
  EXPECT_TRUE(fs::is_empty(place / "batch/new"));
  EXPECT_THAT(all_of(folder), SizeIs(0));
  // Behind it: the ticket is what a second one finds.
  write("new/" + key + ".0@late", told("late"));
  write("tasks/" + key, told("late"));
  EXPECT_FALSE(folder.enrol(task_of(1), "second"));
  folder.tickets().finish_enrolling([](const std::string&) { return false; });
  EXPECT_THAT(folder.tickets().at(TicketPlace::todo), SizeIs(1));
  folder.tickets().finish_enrolling([](const std::string&) { return true; });
  EXPECT_THAT(all_of(folder), SizeIs(1));
}

TEST(BatchFolders, HoldOneOrder) {
  const TemporaryFolder place;
  BatchFolder::make(place / "batch", kOrder);
  EXPECT_EQ(BatchFolder::make(place / "batch", kOrder).order(), kOrder);
  const auto refusal = [&](const BatchOrder& order, const std::string& folder) -> std::string {
    try {
      BatchFolder::make(place / folder, order);
    } catch (const InputError& error) {
      return error.what();
    }
    return "taken";
  };
  EXPECT_THAT(refusal({"fit", {"--quick"}, "xxh3:1", "0.0", false}, "batch"),
              HasSubstr("its captures are worked on by `check`, not by `fit`"));
  EXPECT_THAT(refusal({"check", {}, "xxh3:1", "0.0", false}, "batch"),
              HasSubstr("it was begun with other options: --quick"));
  EXPECT_THAT(refusal({"check", {"--quick"}, "xxh3:2", "0.1", false}, "batch"),
              HasSubstr("it was begun by another program, 0.0 (this is 0.1)"));
  fs::create_directories(place / "mine");
  std::ofstream(place / "mine/thesis.tex") << "x";
  EXPECT_THAT(refusal(kOrder, "mine"), HasSubstr("something else than a batch: thesis.tex"));
  std::ofstream(place / "file") << "x";
  EXPECT_THAT(refusal(kOrder, "file"), HasSubstr("this is a file, not a folder"));
  EXPECT_THROW(BatchFolder::open(place / "mine"), InputError);
}

}  // namespace
}  // namespace hookeye::test
