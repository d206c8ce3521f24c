// MATLAB files: version 5 (with and without compression) and version 7.3, which is HDF5 behind 512 bytes of text.

#include "libchar/core/error.hpp"
#include "libchar/log/arrays/array_tables.hpp"
#include "libchar/log/arrays/hdf5_file.hpp"
#include "libchar/log/arrays/matlab5.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/detail/format.hpp"

namespace libchar {
namespace {

bool is_matlab_73(std::string_view first_bytes) {
  return first_bytes.starts_with("MATLAB 7.3 MAT-file") || first_bytes.starts_with("\x89HDF");
}

bool certain_matlab(std::string_view first_bytes) {
  return first_bytes.starts_with("MATLAB 5.0 MAT-file") ||
         first_bytes.starts_with("MATLAB 7.3 MAT-file");
}

bool sniff_matlab(const std::string&, std::string_view first_bytes) {
  return certain_matlab(first_bytes);
}

std::unique_ptr<TopicReader> open_matlab(const std::string& path, const ReadOptions&) {
  const bool hdf5 = is_matlab_73(BinaryFile(path).head(32));
  return array_tables(hdf5 ? open_hdf5_file(path, "MATLAB 7.3") : open_matlab5_file(path), path);
}

}  // namespace

Format matlab_format() {
  Format row;
  row.about.name = "matlab";
  row.about.title = "MATLAB";
  row.about.suffixes = {".mat"};
  row.about.names = "yes";
  row.about.units = "as suffixes";
  row.about.rate = "by a time array, or fs";
  row.about.start = "by a time array";
  row.about.topics = true;
  row.certain = certain_matlab;
  row.sniff = sniff_matlab;
  row.topics = open_matlab;
  return row;
}

}  // namespace libchar
