#pragma once
// The columns of what a replay or a fusion made.

#include <stdexcept>
#include <string>
#include <vector>

#include "libchar/replay/replay.hpp"

struct KeptColumns final : libchar::ColumnSink {
  void begin(const libchar::LogInfo& info) override { head = info; }
  void block(std::span<const std::span<const double>> some) override {
    columns.resize(some.size());
    for (std::size_t c = 0; c < some.size(); ++c) columns[c].insert(columns[c].end(), some[c].begin(), some[c].end());
  }
  const std::vector<double>& of(const std::string& name) const {
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (head.channels[c].name == name) return columns[c];
    throw std::runtime_error("no " + name);
  }
  libchar::LogInfo head;
  std::vector<std::vector<double>> columns;
};
