#include "libchar/report/replay_html.hpp"

#include "libchar/report/escape.hpp"
#include "libchar/report/replay_markdown.hpp"

namespace libchar {

std::string replay_html(const ReplayResult& result) {
  return "<!doctype html><meta charset=\"utf-8\"><pre>" + html_text(replay_markdown(result)) +
         "</pre>";
}

}  // namespace libchar
