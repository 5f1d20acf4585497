// Parts and stages of the work: each second of the processor counts once.
#include "core/work_clock.h"

#include <gmock/gmock.h>

#include <ctime>
#include <thread>

namespace hookeye::test {
namespace {

/// Keeps the calling thread's processor busy.
void work(double seconds) {
  const auto now = [] {
    timespec t{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
  };
  for (const double end = now() + seconds; now() < end;) {
  }
}

double at(const WorkTable& table, WorkStage stage, WorkPart part) {
  return table.cpu_s[static_cast<int>(stage)][static_cast<int>(part)];
}

TEST(WorkClock, InnerPartsAreNotCountedTwiceAndThreadsAdd) {
  const WorkTable before = worked();
  {
    const WorkingAt stage(WorkStage::fit);
    const Working outer(WorkPart::equilibria);
    work(0.02);
    {
      const Working inner(WorkPart::rays);
      work(0.04);
    }
    std::thread other([] {
      const Working part(WorkPart::rays);
      work(0.03);
    });
    other.join();
  }
  work(0.02);
  const WorkTable after = worked();
  const auto spent = [&](WorkStage stage, WorkPart part) {
    return at(after, stage, part) - at(before, stage, part);
  };
  // Seconds of these threads alone, whatever else the machine does.
  EXPECT_NEAR(spent(WorkStage::fit, WorkPart::equilibria), 0.02, 0.01);
  EXPECT_NEAR(spent(WorkStage::fit, WorkPart::rays), 0.07, 0.01);
  EXPECT_GE(spent(WorkStage::rest, WorkPart::other), 0.01);
  EXPECT_EQ(spent(WorkStage::rest, WorkPart::rays), 0.0);
  EXPECT_GT(after.wall_s, before.wall_s);
}

TEST(WorkClock, AnotherMeshKeepsItsPartsTogether) {
  const WorkTable before = worked();
  {
    const Working finer(WorkPart::finer_mesh);
    const Working inner(WorkPart::equilibria);
    work(0.02);
  }
  const WorkTable after = worked();
  EXPECT_NEAR(at(after, WorkStage::rest, WorkPart::finer_mesh) -
                  at(before, WorkStage::rest, WorkPart::finer_mesh),
              0.02, 0.01);
  EXPECT_EQ(at(after, WorkStage::rest, WorkPart::equilibria),
            at(before, WorkStage::rest, WorkPart::equilibria));
}

TEST(WorkClock, AnExceptionLeavesThePartAndTheStage) {
  try {
    const WorkingAt stage(WorkStage::trials);
    const Working part(WorkPart::sums);
    throw 1;
  } catch (int) {
  }
  const WorkTable before = worked();
  work(0.01);
  const WorkTable after = worked();
  EXPECT_EQ(at(after, WorkStage::trials, WorkPart::sums),
            at(before, WorkStage::trials, WorkPart::sums));
}

}  // namespace
}  // namespace hookeye::test
