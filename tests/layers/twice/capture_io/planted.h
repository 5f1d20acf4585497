namespace hookeye {
class Planted;
enum class Kind { one };
class Planted final {};
}  // namespace hookeye
