#pragma once
// What runs in the child process (child_process.hpp): the HDF5 library, which opens one file, lists
// its datasets and reads rows of them. Nothing outside of the file is touched: external and soft
// links, external storage, virtual datasets and plug-ins are never followed.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libchar/log/arrays/child_process.hpp"
#include "libchar/log/arrays/log_array.hpp"

namespace libchar {

/// Is HDF5 built in?
bool hdf5_is_here();

/// What a child says of a file.
struct Hdf5Listing {
  std::string refusal;  ///< why the file cannot be read; "" when it can
  std::vector<LogArray> arrays;
  std::vector<SaidNumber> said;
  std::vector<std::string> left_out;  ///< "NAME is a soft link"
};

std::string encode(const Hdf5Listing& listing);
/// False for bytes that are no listing.
bool decode(std::string_view bytes, Hdf5Listing& listing);

/// Rows of one array: those of all columns side by side, or of one column.
struct Hdf5Question {
  std::uint64_t array = 0, row = 0, rows = 0, column = 0, planar = 0;
};

/// Answers are a u64 of the bytes that follow, or ~0 for what cannot be read; the first one is the
/// listing, without a question.
std::unique_ptr<Answering> answering_hdf5(const std::string& path);

}  // namespace libchar
