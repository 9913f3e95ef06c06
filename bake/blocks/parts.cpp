#include "bake/blocks/parts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "bake/base/version.h"
#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

void require_same_bake(const Journal& part, const Journal& first) {
  if (part.identity().version != kToolVersion)
    throw Error(fmt::format("{}: is of version {} of the tool; this is {}", part.path(),
                            part.identity().version, kToolVersion));
  const auto difference = part.identity().difference(first.identity());
  if (!difference.empty())
    throw Error(fmt::format("{}: is of another bake than {}: {}", part.path(), first.path(), difference));
  if (part.identity().shards != first.identity().shards)
    throw Error(fmt::format("{}: is one of {} parts, but {} is one of {}", part.path(),
                            part.identity().shards, first.path(), first.identity().shards));
}

// The first ten of them, and how many more there are.
std::string listed(std::vector<std::size_t> numbers) {
  constexpr std::size_t kMost = 10;
  const std::size_t count = numbers.size();
  numbers.resize(std::min(count, kMost));
  const std::string first = fmt::format("{}", fmt::join(numbers, ", "));
  return count > kMost ? fmt::format("{} and {} more", first, count - kMost) : first;
}

}  // namespace

Parts::Parts(const std::vector<std::string>& paths) {
  for (const auto& path : paths) {
    auto part = Journal::read(path);
    const int shard = part->identity().shard, shards = part->identity().shards;
    if (parts_.empty()) parts_.resize(static_cast<std::size_t>(shards));
    const auto any = std::ranges::find_if(parts_, [](const auto& p) { return p != nullptr; });
    require_same_bake(*part, any == parts_.end() ? *part : **any);
    auto& slot = parts_[static_cast<std::size_t>(shard)];
    if (slot)
      throw Error(fmt::format("{}: is part {} of {}, and so is {}", path, shard + 1, shards, slot->path()));
    slot = std::move(part);
  }
  std::vector<std::size_t> missing;
  for (std::size_t k = 0; k < parts_.size(); ++k)
    if (!parts_[k]) missing.push_back(k + 1);
  if (!missing.empty())
    throw Error(fmt::format("of {} parts these are missing: {}", parts_.size(), listed(missing)));
}

void Parts::require_whole(const BakeJob& job) {
  const int shards = static_cast<int>(parts_.size());
  for (int k = 0; k < shards; ++k) {
    const Journal& part = *parts_[static_cast<std::size_t>(k)];
    const TaskRange range = shard_of(job, k, shards);
    std::size_t lacking = 0;
    for (std::size_t task = range.first; task < range.end; ++task) lacking += !part.has(task);
    if (lacking > 0 || part.damaged_bytes() > 0)
      throw Error(fmt::format("{}: is damaged or cut short: {} of its {} blocks cannot be read", part.path(),
                              lacking, range.size()));
    if (part.blocks() != range.size())
      throw Error(fmt::format("{}: holds {} blocks; allowed: the {} of its shard", part.path(), part.blocks(),
                              range.size()));
    ranges_.push_back(range);
  }
}

const Journal& Parts::part(std::size_t task) const {
  const auto after = std::ranges::upper_bound(ranges_, task, {}, &TaskRange::end);
  return *parts_[static_cast<std::size_t>(after - ranges_.begin())];
}

}  // namespace sunbeam
