#pragma once
// Samples between NumPy and the library, without copies: what comes in is looked at, what goes out keeps its vector.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "libchar/core/document/json.hpp"

namespace libchar_python {

namespace py = pybind11;

/// The array owns the vector that was given away.
inline py::array_t<double> to_array(std::vector<double> values) {
  auto kept = std::make_unique<std::vector<double>>(std::move(values));
  const double* first = kept->data();
  const auto size = static_cast<py::ssize_t>(kept->size());
  const py::capsule owner(kept.get(), [](void* p) { delete static_cast<std::vector<double>*>(p); });
  static_cast<void>(kept.release());
  return py::array_t<double>(size, first, owner);
}

/// The samples of a one-dimensional contiguous array of doubles; Python's side has made sure that it is one.
inline std::span<const double> samples_of(const py::array_t<double, py::array::c_style>& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// A document as Python's own types.
inline py::object to_python(const libchar::Json& value) {
  switch (value.type()) {
    case libchar::Json::value_t::object: {
      py::dict out;
      for (const auto& [key, item] : value.items()) out[py::str(key)] = to_python(item);
      return out;
    }
    case libchar::Json::value_t::array: {
      py::list out(value.size());
      for (std::size_t k = 0; k < value.size(); ++k) out[k] = to_python(value[k]);
      return out;
    }
    case libchar::Json::value_t::string:
      return py::str(value.get_ref<const std::string&>());
    case libchar::Json::value_t::boolean:
      return py::bool_(value.get<bool>());
    case libchar::Json::value_t::number_integer:
      return py::int_(value.get<std::int64_t>());
    case libchar::Json::value_t::number_unsigned:
      return py::int_(value.get<std::uint64_t>());
    case libchar::Json::value_t::number_float:
      return py::float_(value.get<double>());
    default:
      return py::none();
  }
}

}  // namespace libchar_python
