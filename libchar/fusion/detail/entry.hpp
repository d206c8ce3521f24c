#pragma once
// The row of an algorithm in the table, made from what its struct declares (algorithm.hpp).

#include <memory>

#include "libchar/fusion/detail/algorithm_list.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/fusion/why_not.hpp"

namespace libchar::fusion {

template <Algorithm A>
std::unique_ptr<Runner> make_runner(const Array& array, const Settings& settings) {
  refuse_where_it_cannot_run(A::description, array);
  return std::make_unique<RunnerOf<A>>(array, settings);
}

template <Algorithm A>
double declared_cost_ns(const Array& array, const Settings& settings) {
  if constexpr (HasCost<A>) return A::cost_ns(array, settings);
  return 10.0 * static_cast<double>(array.channels * array.inputs());
}

template <Algorithm A>
constexpr Entry entry() {
  if constexpr (HasOptions<A>)
    return {&A::description, A::options, &make_runner<A>, &declared_cost_ns<A>};
  else
    return {&A::description, {}, &make_runner<A>, &declared_cost_ns<A>};
}

}  // namespace libchar::fusion
