#pragma once
// What is kept from one Welch spectrum to the next: halves of one length and a sum to go with each.

#include <cstddef>
#include <mutex>
#include <vector>

#include "libchar/spectrum/detail/half_rows.hpp"
#include "libchar/spectrum/detail/half_segments.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {

struct WelchWorkspace::State {
  struct Piece {
    HalfSegments halves;
    HalfSegments::SumsPointer sums;
  };
  half_segments::RowPools pools;

  Piece take(std::size_t segment);
  void give_back(Piece piece);

 private:
  std::mutex mutex_;
  std::vector<Piece> idle_;
};

}  // namespace libchar
