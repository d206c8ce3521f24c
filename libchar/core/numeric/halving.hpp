#pragma once
// A record of any length as parts of 1, 2, 4… samples, in constant memory: of too many each two become one.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/core/numeric/state_archive.hpp"
#include "libchar/core/numeric/whole.hpp"

namespace libchar::detail {

/// At most `kMost` parts. Part: `take(samples)` and `join(later)`, `layout(archive, part)` for its state.
template <class Part, std::size_t kMost>
struct Halving {
  std::uint64_t length = 1;  ///< samples of a part, a power of two
  std::uint64_t filled = 0;  ///< samples in the part that is open
  Part open = {};
  std::vector<Part> parts = {};

  std::uint64_t samples() const { return parts.size() * length + filled; }

  void push(std::span<const double> samples) {
    while (!samples.empty()) {
      const std::size_t some = std::min(samples.size(), detail::in_memory(length - filled));
      open.take(samples.first(some));
      filled += some;
      samples = samples.subspan(some);
      if (filled == length) close();
    }
  }

  /// The samples that `later` has seen follow directly: the same as if they had been pushed here. They must
  /// be at most the largest power of two that divides the number of those before: else std::logic_error.
  void join(Halving later) {
    while (length < later.length) halve();
    while (later.length < length) later.halve();
    if (filled != 0) {  // a short piece within the part that is open
      if (!later.parts.empty() || filled + later.filled > length)
        throw std::logic_error("records joined where a part straddles");
      open.join(later.open);
      filled += later.filled;
      if (filled == length) close();
      return;
    }
    parts.insert(parts.end(), later.parts.begin(), later.parts.end());
    open = later.open;
    filled = later.filled;
    while (parts.size() >= kMost) halve();
  }

  void write_state(StateWriter& to) const {
    to(length, filled);
    std::vector<Part> all = parts;
    all.push_back(open);
    to.list(all, sizeof(Part), [&](const Part& part) { Part::layout(to, part); });
  }

  /// Refuses what contradicts itself as `what`.
  void read_state(StateReader& from, std::string_view what) {
    from(length, filled);
    from.list(parts, sizeof(Part), [&](Part& part) { Part::layout(from, part); });
    if (parts.empty() || parts.size() > kMost || !std::has_single_bit(length) || filled >= length) from.refuse(what);
    open = std::move(parts.back());
    parts.pop_back();
  }

  /// Half as many parts. One without a partner is of the one that is open.
  void halve() {
    for (std::size_t i = 0; i < parts.size() / 2; ++i) {
      Part pair = parts[2 * i];
      pair.join(parts[2 * i + 1]);
      parts[i] = pair;
    }
    if (parts.size() % 2 != 0) {
      Part last = parts.back();
      last.join(open);
      open = last;
      filled += length;
    }
    parts.resize(parts.size() / 2);
    length *= 2;
  }

 private:
  void close() {
    parts.push_back(std::exchange(open, {}));
    filled = 0;
    if (parts.size() == kMost) halve();
  }
};

}  // namespace libchar::detail
