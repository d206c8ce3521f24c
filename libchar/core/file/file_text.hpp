#pragma once
// Reading what is small at once. A device that fails is an error, never a shorter text.

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace libchar {

/// What is left of an open file, at most `most` bytes. `path` is for the message. Throws Error(input).
std::string rest_of_file(int descriptor, const std::string& path, std::size_t most);

/// A file of any length, a piece after the other. Throws Error(input) where it cannot be opened or read.
void for_pieces_of_file(const std::string& path, std::size_t piece_bytes,
                        const std::function<void(std::string_view)>& take);

/// The first `most` bytes of a file, all of a smaller one. Throws Error(input) where it cannot be opened or read.
std::string file_text(const std::string& path, std::size_t most);

}  // namespace libchar
