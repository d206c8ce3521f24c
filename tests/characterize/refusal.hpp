#pragma once
// What tests of characterizations share.

#include <string>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/error.hpp"

namespace test {

/// Code and sentence of the error that a characterization ends in; "" when it ends in none.
inline std::string refusal(const libchar::Recording& recording, const libchar::CharacterizeOptions& options) {
  try {
    characterize(recording, options);
  } catch (const libchar::Error& error) {
    return error.problem().code + " " + error.problem().what;
  }
  return "";
}

}  // namespace test
