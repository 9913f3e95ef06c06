// This generator makes random numbers from an explicit (seed, stream): the same pair gives the same numbers
// on every machine and for every thread count. It is PCG32 (O'Neill 2014); SplitMix64 mixes state and
// increment from the pair, so that neighbouring streams are unrelated.
#pragma once

#include <cstdint>

namespace sunbeam {
inline namespace v1 {

class Rng {
 public:
  Rng(std::uint64_t seed, std::uint64_t stream) {
    std::uint64_t mix = seed;
    mix = next_mix(mix) ^ (stream * 0xd1342543de82ef95ull);
    increment_ = (next_mix(mix) << 1) | 1;
    state_ = next_mix(mix);
  }

  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ull + increment_;
    const auto xorshifted = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto rotation = static_cast<std::uint32_t>(old >> 59);
    return (xorshifted >> rotation) | (xorshifted << ((32 - rotation) & 31));
  }

  // Returns a uniform number in [0, 1) of 32 random bits.
  double uniform() { return next() * 0x1p-32; }

 private:
  static std::uint64_t next_mix(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }

  std::uint64_t state_, increment_;
};

}  // namespace v1
}  // namespace sunbeam
