#pragma once
// The alignment and the error budget of a replay, in each of its reports; "" without an alignment.

#include <string>

#include "libchar/core/text/text_table.hpp"
#include "libchar/replay/view/replay_view.hpp"
#include "libchar/report/detail/escape.hpp"

namespace libchar {

std::string alignment_text(const ReplayView& view, const TextLook& look);
std::string alignment_markdown(const ReplayView& view);
std::string alignment_html(const ReplayView& view);

}  // namespace libchar
