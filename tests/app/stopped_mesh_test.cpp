// Ctrl-C while TetGen fills a body: the program ends soon, and TetGen with it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

class StoppedMesh : public Cli {
 protected:
  /// So fine that TetGen works for many seconds. `whom`: who gets the signal once TetGen computes;
  /// a terminal sends it to all of the group. Out: seconds that the program lived on, and how many
  /// helpers did.
  Result stop_meshing(const std::string& signal, const std::string& whom) const {
    write("stop.sh",
          fmt::format(R"sh(cd '{}'
setsid sh -c '"{}" mesh cube.obj --edge 0.22 -o body.vtu >out.txt 2>err.txt </dev/null & echo $! >program; wait $!; echo $? >status' &
until [ -s program ]; do sleep 0.01; done
program=$(cat program)
computing() {{
  for child in $(pgrep -P $program -x tetgen); do
    # Field 14 of stat: ticks in user mode; 50 are half a second.
    [ "$(cut -d ' ' -f 14 /proc/$child/stat 2>/dev/null || echo 0)" -ge 50 ] && echo $child
  done
  }
} until[-n "$(computing)"];
do kill - 0 $program 2 > / dev / null || exit 1;
sleep 0.02;
done tetgen = $(computing) began = $(date + % s % N) {}
until[-s status];
do sleep 0.01; done
echo $(( ($(date +%s%N) - began) / 1000000 )) >milliseconds
kill -0 $tetgen 2>/dev/null && echo TetGen goes on >left
exit 0
)sh",
                      folder_.string(), HOOKEYE_PROGRAM,
                      "kill -" + signal + (whom == "all" ? " $program $tetgen" : " $program")));
    for (const char* old : {"program", "status", "milliseconds", "left"}) fs::remove(folder_ / old);
    const int status = std::system(fmt::format("sh '{}/stop.sh'", folder_.string()).c_str());
    EXPECT_EQ(status, 0) << "TetGen was never seen at work\n" << read(folder_ / "err.txt");
    return {status == 0 ? std::stoi(read(folder_ / "status")) : -1, read(folder_ / "out.txt"),
            read(folder_ / "err.txt")};
  }
};

TEST_F(StoppedMesh, TetGenEndsWithTheProgram) {
  write_cube("[0, 0, 1]");
  const std::pair<const char*, const char*> cases[] = {
      {"INT", "program"}, {"INT", "all"}, {"TERM", "program"}};
  for (const auto& [signal, whom] : cases) {
    SCOPED_TRACE(fmt::format("{} to {}", signal, whom));
    const Result stopped = stop_meshing(signal, whom);
    EXPECT_EQ(stopped.status, 130) << stopped.err;
    EXPECT_THAT(stopped.err, HasSubstr("stopp"));
    EXPECT_FALSE(fs::exists(folder_ / "left"));
    EXPECT_FALSE(fs::exists(folder_ / "body.vtu"));
    EXPECT_LT(std::stoi(read(folder_ / "milliseconds")), 2000);
  }
}

}  // namespace
}  // namespace hookeye::test
