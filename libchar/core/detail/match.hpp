#pragma once
// What to do with a variant, one case a type: std::visit(Match{[](double x) {…}, [](const std::string& s) {…}}, value).

namespace libchar {

template <class... Cases>
struct Match : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Match(Cases...) -> Match<Cases...>;

}  // namespace libchar
