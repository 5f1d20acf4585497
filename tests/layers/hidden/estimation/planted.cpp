namespace hookeye {
class Planted;
struct Kind {};
namespace {
struct Planted {};
}  // namespace
}  // namespace hookeye
