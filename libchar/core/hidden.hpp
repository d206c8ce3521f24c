#pragma once
// What a class keeps out of its header: it moves with the class and is destroyed by whoever made it, so that the class
// needs no destructor and no moves of its own.
//
//   class Meter {                                       struct Meter::State { … };
//     struct State;                                     Meter::Meter() : state_(detail::hidden<State>()) {}
//     detail::Hidden<State> state_;
//   };

#include <memory>
#include <utility>

namespace libchar::detail {

template <class T>
struct Destroyer {
  void (*destroy)(T*) = nullptr;
  void operator()(T* object) const { destroy(object); }
};

template <class T>
using Hidden = std::unique_ptr<T, Destroyer<T>>;

template <class T, class... Arguments>
Hidden<T> hidden(Arguments&&... arguments) {
  return {new T(std::forward<Arguments>(arguments)...), {[](T* object) { delete object; }}};
}

}  // namespace libchar::detail
