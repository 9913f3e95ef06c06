// This file gives the BSDF of a material at a hit: one for the whole surface, or one made from parameters
// that vary over it.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>

#include "sunbeam/bsdf.h"
#include "sunbeam/parameters.h"

namespace sunbeam {

// Has room for one BSDF made at a hit, so that a small one need not be allocated.
class BsdfRoom {
 public:
  BsdfRoom() = default;
  ~BsdfRoom() {
    if (bsdf_) bsdf_->~Bsdf();
    delete large_;
  }
  BsdfRoom(const BsdfRoom&) = delete;
  BsdfRoom& operator=(const BsdfRoom&) = delete;

  // Makes a BSDF in the room; it may be called once for each room.
  template <class T, class... Args>
  const Bsdf& emplace(Args&&... args) {
    static_assert(sizeof(T) <= kSize && alignof(T) <= kAlignment);
    bsdf_ = new (bytes_) T(std::forward<Args>(args)...);
    return *bsdf_;
  }

  // Takes a BSDF over, instead of emplace().
  const Bsdf& adopt(std::unique_ptr<const Bsdf> bsdf) {
    large_ = bsdf.release();
    return *large_;
  }

 private:
  static constexpr std::size_t kSize = 512, kAlignment = 64;
  alignas(kAlignment) std::byte bytes_[kSize];
  Bsdf* bsdf_ = nullptr;
  const Bsdf* large_ = nullptr;
};

class VaryingBsdf {
 public:
  virtual ~VaryingBsdf() = default;

  // Returns the BSDF for these parameters, in `room` or shared; it lives no longer than both. Many threads
  // call it at once.
  virtual const Bsdf& at(const Parameters& parameters, BsdfRoom& room) const = 0;
};

// Holds exactly one of the two; they are owned elsewhere.
struct SurfaceBsdf {
  SurfaceBsdf(const Bsdf* uniform_bsdf) : uniform(uniform_bsdf) {}
  SurfaceBsdf(const VaryingBsdf* varying_bsdf) : varying(varying_bsdf) {}

  const Bsdf* uniform = nullptr;
  const VaryingBsdf* varying = nullptr;  // takes its parameters from the SceneMaterial's fields
};

}  // namespace sunbeam
