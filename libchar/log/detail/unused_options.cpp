#include "libchar/log/detail/unused_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "libchar/core/refusal.hpp"
#include "libchar/log/reading_fields.hpp"

namespace libchar {
namespace {

struct ForSome {
  std::string_view option;
  bool (*takes)(const LogFormat& format);
  const char* who;  ///< has an effect on these only
};

bool is_text(const LogFormat& format) { return format.text; }
bool has_topics(const LogFormat& format) { return format.topics; }

constexpr const char* kText = "tables of text";
constexpr ForSome kForSome[] = {
    {"topic", has_topics, "logs that may hold several streams"},
    {"time_source", [](const LogFormat& f) { return f.time_sources; }, "logs whose messages have stamps"},
    {"msg", [](const LogFormat& f) { return f.name == "db3" || f.name == "mcap" || f.name == "rosbag2"; },
     "recordings of ROS 2"},
    {"preset", [](const LogFormat& f) { return f.name == "imu"; }, ".imu files"},
    {"overflow_as_missing", [](const LogFormat& f) { return !f.topics; }, "text and arrays"},
    {"delimiter", is_text, kText},
    {"decimal", is_text, kText},
    {"header", is_text, kText},
    {"encoding", is_text, kText},
    {"where", is_text, kText},
    {"group_by", is_text, kText},
    {"date_order", is_text, kText},
    {"skip_rows", is_text, kText},
    {"skip_repeated_header", is_text, kText}};

Refusal refusal(const std::string& option) { return usage_error("E0336", "`" + option + "`").hint("leave it out"); }

}  // namespace

void refuse_unused_options(const LogFormat& format, const ReadOptions& options) {
  for (const std::string& option : options_given(options)) {
    const auto* row = std::find_if(std::begin(kForSome), std::end(kForSome),
                                   [&](const ForSome& one) { return one.option == option; });
    if (row == std::end(kForSome) || row->takes(format)) continue;
    throw refusal(option).says("has an effect on {} only, and this log is {}", row->who, format.name);
  }
  if (options.time_unit != "auto" && options.time_column == "none")
    throw refusal("time_unit").says("has no effect where no column holds stamps");
}

}  // namespace libchar
