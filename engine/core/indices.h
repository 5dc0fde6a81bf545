#pragma once

#include <cstddef>
#include <iterator>

namespace rmlcell {

// 0 .. count - 1, for a range-for. (clang 14 does not compile std::views::iota of g++ 12.)
class Indices {
 public:
  constexpr explicit Indices(std::size_t count) : count_(count) {}

  struct Iterator {
    std::size_t at;
    constexpr std::size_t operator*() const { return at; }
    constexpr Iterator& operator++() {
      ++at;
      return *this;
    }
    constexpr bool operator==(const Iterator&) const = default;
  };
  constexpr Iterator begin() const { return {0}; }
  constexpr Iterator end() const { return {count_}; }

 private:
  std::size_t count_;
};

// Those of a list, to walk several of one length side by side.
template <class List>
constexpr Indices IndicesOf(const List& list) {
  return Indices(std::size(list));
}

}  // namespace rmlcell
