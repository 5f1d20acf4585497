// Tags as people tell them.
#include "placing/tags.h"

#include <gmock/gmock.h>

#include "core/text_file.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

std::vector<BodyTag> tags_of(const std::string& text) {
  const TemporaryFolder folder;
  write_text(folder / "tags.txt", text);
  return read_tags(folder / "tags.txt");
}

std::string refused(const std::string& text) {
  try {
    tags_of(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Tags, CornersGoRoundFromTheUpperLeft) {
  const auto tags = tags_of("# two\n\n7 12  0 -10 40  2 0 0  0 0 -1\n3, 4, 1,2,3, 0,1,0, 0,0,-3\n");
  ASSERT_EQ(tags.size(), 2u);
  EXPECT_EQ(tags[0].id, 7);
  EXPECT_EQ(tags[1].place.line, 4);
  const Vector3d expected[] = {{-6, -10, 46}, {6, -10, 46}, {6, -10, 34}, {-6, -10, 34}};
  for (int k = 0; k < 4; ++k) EXPECT_LT((tags[0].corner(k) - expected[k]).norm(), 1e-12) << k;
  EXPECT_LT((tags[1].corner(0) - Vector3d(1, 0, 5)).norm(), 1e-12);
}

TEST(Tags, RefusalsNameTheLine) {
  EXPECT_THAT(refused("7 12 0 0 0 1 0 0 0 1"), HasSubstr("tags.txt:1"));
  EXPECT_THAT(refused("7 12 0 0 0 1 0 0 0 1"), HasSubstr("no tag of eleven numbers"));
  EXPECT_THAT(refused("7.5 12 0 0 0 1 0 0 0 1 0"), HasSubstr("7.5 is no number of a tag"));
  EXPECT_THAT(refused("7 -1 0 0 0 1 0 0 0 1 0"), HasSubstr("the tag is -1 wide"));
  EXPECT_THAT(refused("7 1 0 0 0 1 0 0 0 0 0"), HasSubstr("a direction of the tag is (0, 0, 0)"));
  EXPECT_THAT(refused("7 1 0 0 0 1 0 0 1 1 0"), HasSubstr("not at right angles"));
  EXPECT_THAT(refused("7 1 0 0 0 1 0 0 0 1 0\n7 1 9 0 0 1 0 0 0 1 0"),
              HasSubstr("tag 7 stands in line 1, too"));
  EXPECT_THAT(refused("# none\n"), HasSubstr("there is no tag in this file"));
}

}  // namespace
}  // namespace hookeye::test
