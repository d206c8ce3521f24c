#pragma once
// bench.json: what a run of benchmarks writes, and what a later run is held against.

#include <string>
#include <string_view>

#include "libchar/benchmark/bench_report.hpp"
#include "libchar/core/document/fields.hpp"

namespace libchar {

const Fields<BenchReport>& bench_fields();

/// Throws Error(input) for another document, with its place where something in it is wrong.
BenchReport parse_bench_report(std::string_view text, const std::string& path);

}  // namespace libchar
