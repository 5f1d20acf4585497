#include "capture_io/field_start.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "capture_io/capture_reader.h"

namespace hookeye {

namespace {

const ExampleSpec* example_called(const Capture& capture, const std::string& name) {
  const auto found = std::find_if(capture.examples.begin(), capture.examples.end(),
                                  [&](const ExampleSpec& one) { return one.name == name; });
  return found == capture.examples.end() ? nullptr : &*found;
}

/// It has numbers of its own that are fitted after all others where it is held out: how a grip
/// moved.
bool has_own_numbers(const ExampleSpec& example) {
  return std::any_of(
             example.supports.begin(), example.supports.end(),
             [](const SupportSpec& one) { return one.kind == SupportSpec::Kind::rigid_fit; }) ||
         std::any_of(example.measured.begin(), example.measured.end(), [](const MeasuredSpec& one) {
           return one.kind == MeasuredSpec::Kind::travel_of;
         });
}

void check_start(const Capture& capture, const ExampleSpec& example, const MeasuredSpec& field) {
  const std::string& name = start_of(field);
  const ExampleSpec* start = example_called(capture, name);
  const std::string starts =
      fmt::format("the field {} of example `{}` starts from ", field.field->told, example.name);
  if (!start)
    throw InputError(field.place, fmt::format("{}`{}`, and there is no such example", starts, name),
                     suggest(name, names_of(capture.examples)));
  if (start == &example)
    throw InputError(field.place, starts + "its own example",
                     "name the example that the program's reference picture shows, or remove "
                     "`from` where that is the body as it was given");
  if (start->test && !example.test)
    throw InputError(field.place,
                     fmt::format("{}`{}`, which is held out for the test", starts, name),
                     fmt::format("`use: test` here too, or another use of `{}`", name));
  if (start->validate && !example.validate && has_own_numbers(*start))
    throw InputError(
        field.place,
        fmt::format("{}`{}`, which is held out, and how its grip moves is fitted then", starts,
                    name),
        fmt::format("`use: fit` for `{}`: what is held out is fitted to nothing else", name));
}

/// From which examples the fields of each start.
using Starts = std::map<std::string, std::set<std::string>>;

/// Takes away, time and again, the examples that start from none of those that are left.
void leave_circles(Starts& starts) {
  std::map<std::string, std::vector<std::string>> after;
  std::vector<std::string> free;
  std::map<std::string, size_t> waits;
  for (const auto& [name, from] : starts) {
    for (const std::string& one : from) after[one].push_back(name);
    waits[name] = from.size();
    if (from.empty()) free.push_back(name);
  }
  while (!free.empty()) {
    const std::string one = free.back();
    free.pop_back();
    starts.erase(one);
    for (const std::string& next : after[one])
      if (--waits[next] == 0) free.push_back(next);
  }
}

/// A way through what is left that comes back to where it began.
std::vector<std::string> circle_in(const Starts& left, const std::string& first) {
  const auto next_of = [&](const std::string& name) {
    const auto& from = left.at(name);
    return *std::find_if(from.begin(), from.end(),
                         [&](const std::string& one) { return left.count(one) > 0; });
  };
  std::vector<std::string> way{first};
  std::set<std::string> seen{first};
  std::string next = next_of(first);
  for (; seen.insert(next).second; next = next_of(next)) way.push_back(next);
  return {std::find(way.begin(), way.end(), next), way.end()};
}

void check_circles(const Capture& capture) {
  Starts starts;
  for (const ExampleSpec& example : capture.examples)
    for (const MeasuredSpec& measured : example.measured) {
      auto& from = starts[example.name];
      if (!start_of(measured).empty()) from.insert(start_of(measured));
    }
  // Those of which nothing is measured start from none.
  for (const ExampleSpec& example : capture.examples) starts[example.name];
  leave_circles(starts);
  if (starts.empty()) return;
  const std::vector<std::string> circle = circle_in(starts, starts.begin()->first);
  const auto& measured = example_called(capture, circle.front())->measured;
  const auto field = std::find_if(measured.begin(), measured.end(), [&](const auto& one) {
    return start_of(one) == circle[1 % circle.size()];
  });
  throw InputError(field->place,
                   fmt::format("fields start from one another in a circle: `{}` from `{}`",
                               fmt::join(circle, "` from `"), circle.front()),
                   "one of them has the body as it was given as its reference: remove its `from`");
}

}  // namespace

const std::string& start_of(const MeasuredSpec& measured) {
  static const std::string none;
  return measured.field ? measured.region : none;
}

void check_field_starts(const Capture& capture) {
  for (const ExampleSpec& example : capture.examples)
    for (const MeasuredSpec& measured : example.measured)
      if (!start_of(measured).empty()) check_start(capture, example, measured);
  check_circles(capture);
}

}  // namespace hookeye
