// A run folder that goes while the program writes it: told by its name, and it does not come back.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "app/fitted_run.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Removed : public WithSmallCapture {
 protected:
  /// A search whose folder is removed once `sign` stands on standard error.
  Result search_without_its_folder(const std::string& sign) const {
    write("search.sh",
          fmt::format("cd '{}'; rm -rf run; rm -f err.txt; touch err.txt; {{ '{}' discover -v "
                      "capture -o run >out.txt 2>err.txt </dev/null & }}; program=$!; "
                      "while kill -0 $program 2>/dev/null && ! grep -q '{}' err.txt; do sleep "
                      "0.01; done; while ! rm -rf run 2>/dev/null; do :; done; wait $program",
                      folder_.string(), HOOKEYE_PROGRAM, sign));
    const int status = std::system(fmt::format("sh '{}/search.sh'", folder_.string()).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(folder_ / "out.txt"),
            read(folder_ / "err.txt")};
  }
};

TEST_F(Removed, ASearchSaysSoAndEnds) {
  for (const char* sign : {"state: kept", "step base: normalised", "trial: kept"}) {
    const Result ended = search_without_its_folder(sign);
    EXPECT_EQ(ended.status, 2) << sign << "\n" << ended.err;
    EXPECT_THAT(ended.err, AllOf(HasSubstr((folder_ / "run").string()), HasSubstr("was removed")))
        << sign;
    EXPECT_FALSE(fs::exists(folder_ / "run")) << sign;
  }
}

}  // namespace
}  // namespace hookeye::test
