#pragma once
#include <functional>
#include <string>

#include "libchar/core/error.hpp"

namespace test {

/// The code of the Error that `work` throws, "" where it throws none.
inline std::string code_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const libchar::Error& error) {
    return error.problem().code;
  }
  return "";
}

}  // namespace test
