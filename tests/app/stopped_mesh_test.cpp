// Ctrl-C while TetGen fills a body: the program ends soon, and TetGen with it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

/// $1: folder, $2: program, $3: signal, $4: whom it is sent to once TetGen has computed for half a
/// second; a terminal sends it to all. The body is so fine that TetGen works for many seconds.
/// Files tell the exit status, how long the program lived on, and whether TetGen did.
constexpr const char* kStop = R"script(cd "$1"
rm -f program status milliseconds left
setsid sh -c '"$1" mesh cube.obj --edge 0.22 -o body.vtu >out.txt 2>err.txt </dev/null &
  echo $! >program; wait $!; echo $? >status' sh "$2" &
until [ -s program ]; do sleep 0.01; done
program=$(cat program)
ticks() { cut -d " " -f 14 "/proc/$1/stat" 2>/dev/null || echo 0; }
tetgen=
until [ -n "$tetgen" ] && [ "$(ticks "$tetgen")" -ge 50 ]; do
  kill -0 "$program" 2>/dev/null || exit 1
  sleep 0.02
  tetgen=$(pgrep -P "$program" -x tetgen)
done
began=$(date +%s%N)
if [ "$4" = all ]; then kill "-$3" "$program" "$tetgen"; else kill "-$3" "$program"; fi
until [ -s status ]; do sleep 0.01; done
echo $((($(date +%s%N) - began) / 1000000)) >milliseconds
kill -0 "$tetgen" 2>/dev/null && echo yes >left
exit 0
)script";

class StoppedMesh : public Cli {
 protected:
  Result stop_meshing(const std::string& signal, const std::string& whom) const {
    write("stop.sh", kStop);
    const int status = std::system(fmt::format("sh '{0}/stop.sh' '{0}' '{1}' {2} {3}",
                                               folder_.string(), HOOKEYE_PROGRAM, signal, whom)
                                       .c_str());
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
    ASSERT_EQ(stopped.status, 130) << stopped.err;
    EXPECT_THAT(stopped.err, HasSubstr("stopped"));
    EXPECT_FALSE(fs::exists(folder_ / "left"));
    EXPECT_FALSE(fs::exists(folder_ / "body.vtu"));
    EXPECT_LT(std::stoi(read(folder_ / "milliseconds")), 2000);
  }
}

}  // namespace
}  // namespace hookeye::test
