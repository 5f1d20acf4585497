namespace hookeye {
class Planted;
class Planted final {};
namespace detail {
struct Kind {};
}  // namespace detail
}  // namespace hookeye
