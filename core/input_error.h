// Bad input: what the user sees, and where. Exit status 2 (docs: Exit status).
#pragma once

#include <stdexcept>
#include <string>

namespace hookeye {

/// A position in a text file; line and column count from 1, 0 = the file as a whole.
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
  /// "file:line:column", shortened where line or column are unknown.
  std::string str() const;
};

/// Thrown for every fault of the user's input. what() reads
/// "file:line:column: WRONG\n  RIGHT".
class InputError : public std::runtime_error {
 public:
  InputError(Place place, std::string wrong, std::string right);
  const Place& place() const { return place_; }
  const std::string& wrong() const { return wrong_; }
  const std::string& right() const { return right_; }

 private:
  Place place_;
  std::string wrong_;
  std::string right_;
};

/// A fault of a file that the capture names at `named`: one of the file as a whole is told there,
/// the file's name in front; one with a line keeps its place.
InputError told_at(const Place& named, const InputError& error);

/// Of a result that cannot be written; `why` may be empty.
InputError cannot_write(const std::string& file, const std::string& why = "");

/// The entry of `known` nearest to `word` (edit distance without regard to case, at most a third of
/// its length, or one is the other's start), or "".
template <class Strings>
std::string nearest_name(const std::string& word, const Strings& known);
std::string nearest_name_of(const std::string& word, const std::string* begin,
                            const std::string* end);
template <class Strings>
std::string nearest_name(const std::string& word, const Strings& known) {
  return nearest_name_of(word, known.data(), known.data() + known.size());
}

}  // namespace hookeye
