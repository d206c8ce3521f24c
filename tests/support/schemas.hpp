#pragma once
// Documents against docs/schema, in every test that runs the program. The keywords that those schemas use, and no
// others; tests/cli/schema_test.py holds the same against an independent validator.

#include <string>
#include <vector>

namespace test {

/// What is wrong with a document by the schema of its format, with its place; "" when nothing is.
/// One that names no format, or one without a schema, is wrong.
std::string schema_fault(const std::string& document);

/// The same of what a run of the program printed with --json, and of the documents in the folder of
/// its -o (relative to `folder`).
std::string faults_of_run(const std::vector<std::string>& arguments, const std::string& out, const std::string& folder);

}  // namespace test
