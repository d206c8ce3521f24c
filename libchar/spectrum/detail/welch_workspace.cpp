#include "libchar/spectrum/detail/welch_workspace.hpp"

#include <memory>
#include <utility>

namespace libchar {

namespace {

// Halves from here on are of a record that has the memory for itself: 64 MB and more for each of
// seven arrays, wanted for its spectrum next.
constexpr std::size_t kNotKept = std::size_t{1} << 23U;

}  // namespace

WelchWorkspace::State::Piece WelchWorkspace::State::take(std::size_t segment) {
  const std::lock_guard lock(mutex_);
  if (!idle_.empty() && 2 * idle_.back().halves.half() == segment) {
    Piece piece = std::move(idle_.back());
    idle_.pop_back();
    return piece;
  }
  idle_.clear();  // of another length: not needed any more
  HalfSegments halves(segment, &pools);
  auto sums = halves.zero_sums();
  return {std::move(halves), std::move(sums)};
}

void WelchWorkspace::State::give_back(Piece piece) {
  if (piece.halves.half() >= kNotKept) return;
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(piece));
}

WelchWorkspace::WelchWorkspace() : state_(detail::hidden<State>()) {}

}  // namespace libchar
