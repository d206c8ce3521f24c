#pragma once
// MATLAB files of version 5 (save -v6 and -v7, SciPy's savemat, Octave's -mat7-binary) as a container of arrays.
// Source: MathWorks, MAT-File Format (R2023b), chapter 1: 128 bytes of header, then data elements,
// compressed or not, matrices within matrices. Read here and not by a library: in constant memory
// where elements are compressed, and without trust in any length.

#include <memory>
#include <string>

#include "libchar/log/arrays/log_array.hpp"

namespace libchar {

/// Throws Error(input): E0464 for what is broken, with its byte.
std::unique_ptr<ArrayContainer> open_matlab5_file(const std::string& path);

}  // namespace libchar
