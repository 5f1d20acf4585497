namespace hookeye {
struct Planted {};
}  // namespace hookeye
