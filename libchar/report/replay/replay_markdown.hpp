#pragma once
// report.md of a replay: verdict and tables, for a pull request or a mail.

#include <string>

#include "libchar/replay/view/replay_view.hpp"

namespace libchar {

std::string replay_markdown(const ReplayView& view);
/// The same with a view made for it alone.
std::string replay_markdown(const ReplayResult& result);

}  // namespace libchar
