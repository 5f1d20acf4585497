#include "core/journal.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <random>

#include "core/input_error.h"
#include "core/text_file.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> all(const Journal& journal) {
  std::vector<std::string> out;
  for (size_t i = 0; i < journal.size(); ++i) out.push_back(journal.read(i));
  return out;
}

/// Bytes of any kind, frames of records among them.
const std::vector<std::string> kRecords = {"one", "", std::string("two\nlines\0and a null", 20),
                                           "12 0123\nlike a frame\n", std::string(70000, 'x')};

class JournalTest : public testing::Test {
 protected:
  void fill() const {
    Journal journal(file(), "this");
    for (const std::string& record : kRecords) journal.add(record);
  }
  fs::path file() const { return folder_ / "archive"; }

  TemporaryFolder folder_;
};

TEST_F(JournalTest, RecordsComeBack) {
  { const Journal journal(file(), "this"); }
  EXPECT_FALSE(fs::exists(file())) << "there is nothing to keep";
  fill();
  Journal again(file(), "this");
  EXPECT_EQ(all(again), kRecords);
  EXPECT_EQ(again.add("more"), kRecords.size());
  EXPECT_EQ(again.read(kRecords.size()), "more");
  EXPECT_EQ(again.read(3), kRecords[3]);
  EXPECT_EQ(Journal(file(), "this").size(), kRecords.size() + 1);
}

TEST_F(JournalTest, HalfARecordAtTheEndIsDropped) {
  Journal(file(), "this").add("first");
  const size_t whole = fs::file_size(file());
  Journal(file(), "this").add("the second one");
  const std::string text = read_text(file());
  for (size_t left = whole; left < text.size(); ++left) {
    write_text(file(), text.substr(0, left));
    Journal cut(file(), "this");
    EXPECT_THAT(all(cut), testing::ElementsAre("first")) << left;
    cut.add("third");
    EXPECT_THAT(all(Journal(file(), "this")), testing::ElementsAre("first", "third")) << left;
  }
}

TEST_F(JournalTest, WhatADamagedRecordLeavesBeforeItStays) {
  fill();
  std::string text = read_text(file());
  text[text.find("like a frame")] ^= 1;
  write_text(file(), text);
  EXPECT_EQ(all(Journal(file(), "this")),
            std::vector<std::string>(kRecords.begin(), kRecords.begin() + 3));
  for (const std::string& other : {std::string(), std::string("{}"), std::string(1000, '\n')}) {
    write_text(file(), other);
    EXPECT_EQ(Journal(file(), "this").size(), 0U);
  }
}

TEST_F(JournalTest, AFileThatIsRemovedMeanwhileIsToldByItsFolder) {
  Journal journal(file(), "this");
  journal.add("first");
  fs::remove(file());
  try {
    journal.add("second");
    FAIL() << "written to a file without a name";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().file, folder_.path().string());
    EXPECT_THAT(error.wrong(), testing::HasSubstr("archive in it, was removed"));
  }
  write_text(file(), "another one");
  EXPECT_THROW(journal.add("third"), InputError);
  EXPECT_EQ(read_text(file()), "another one");
}

TEST_F(JournalTest, WhatIsOverwrittenMeanwhileIsNotTakenForARecord) {
  Journal journal(file(), "this");
  journal.add("first");
  const auto size = fs::file_size(file());
  std::ofstream(file(), std::ios::binary | std::ios::trunc) << std::string(size, '\0');
  EXPECT_THROW(journal.read(0), InputError);
}

TEST_F(JournalTest, RecordsForSomethingElseAreNotRead) {
  fill();
  Journal other(file(), "that");
  EXPECT_EQ(other.size(), 0U);
  EXPECT_EQ(Journal(file(), "this").size(), kRecords.size()) << "nothing was added yet";
  other.add("of that");
  EXPECT_THAT(all(Journal(file(), "that")), testing::ElementsAre("of that"));
  EXPECT_EQ(Journal(file(), "this").size(), 0U);
}

TEST_F(JournalTest, AKillLeavesWholeRecords) {
  std::mt19937 random(7);
  for (int kill = 0; kill < 20; ++kill) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      Journal journal(file(), "this");
      while (true) journal.add(std::to_string(journal.size()) + std::string(100000, 'y'));
    }
    ::usleep(500 + random() % 20000);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const Journal left(file(), "this");
    for (size_t i = 0; i < left.size(); ++i)
      ASSERT_EQ(left.read(i).substr(0, left.read(i).find('y')), std::to_string(i));
  }
  EXPECT_GT(Journal(file(), "this").size(), 0U);
}

TEST_F(JournalTest, AnotherProcessReadsOn) {
  JournalReader reader(file(), "this"), other(file(), "that");
  reader.look();
  EXPECT_EQ(reader.size(), 0U) << "there is no file yet";
  Journal journal(file(), "this");
  for (size_t i = 0; i < kRecords.size(); ++i) {
    journal.add(kRecords[i]);
    reader.look();
    ASSERT_EQ(reader.size(), i + 1);
    EXPECT_EQ(reader.read(i), kRecords[i]);
  }
  EXPECT_FALSE(reader.strange());
  other.look();
  EXPECT_TRUE(other.strange());
  EXPECT_EQ(other.size(), 0U);
  // A record that comes in two halves.
  const std::string text = read_text(file());
  journal.add("the last one");
  const std::string whole = read_text(file());
  write_text(file(), whole.substr(0, text.size() + 20));
  reader.look();
  EXPECT_EQ(reader.size(), kRecords.size());
  write_text(file(), whole);
  reader.look();
  ASSERT_EQ(reader.size(), kRecords.size() + 1);
  EXPECT_EQ(reader.read(kRecords.size()), "the last one");
  write_text(file(), "begun anew");
  reader.look();
  EXPECT_EQ(reader.read(0), std::nullopt);
}

TEST_F(JournalTest, SaysThatItCannotBeWritten) {
  Journal journal(folder_ / "gone" / "archive", "this");
  EXPECT_THROW(journal.add("one"), InputError);
}

}  // namespace
}  // namespace hookeye::test
