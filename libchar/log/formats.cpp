#include "libchar/log/detail/row_source.hpp"

namespace libchar {

const std::vector<Format>& formats() {
  static const std::vector<Format> table = {
      {"npy", ".npy", sniff_npy, open_npy},
      {"raw", ".f64 .f32 .i16 .i32 .bin .raw", sniff_raw, open_raw},
      {"csv", ".csv .tsv .txt .dat", sniff_csv, open_csv},
  };
  return table;
}

}  // namespace libchar
