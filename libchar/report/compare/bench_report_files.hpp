#pragma once
// Benchmarks as files and for a terminal.

#include <filesystem>
#include <string>
#include <vector>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/file/output_files.hpp"

namespace libchar {

std::string bench_text(const BenchReport& report);
std::string bench_markdown(const BenchReport& report);
std::string bench_html(const BenchReport& report);

/// The page, the document and the Markdown, named bench, in this folder.
std::vector<OutputFile> bench_files(const BenchReport& report, const std::filesystem::path& folder);

}  // namespace libchar
