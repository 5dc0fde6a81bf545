#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <concepts>
#include <cstdlib>
#include <type_traits>
#include <utility>

// What switched_source.py puts into a source: every change of it at once, each asleep until
// MUTATION_CHANGE names it. Which ones a run comes by is noted in the file that MUTATION_REACHED
// names, shared by all its processes.
namespace rmlcell::changes {

inline constexpr unsigned kMost = 1U << 20;
inline unsigned char no_file[kMost] = {};
inline constinit unsigned char* reached = no_file;
inline constinit unsigned awake = 0;

inline bool Begin() {
  if (const char* change = std::getenv("MUTATION_CHANGE"))
    awake = static_cast<unsigned>(std::atoi(change));
  const char* name = std::getenv("MUTATION_REACHED");
  if (name == nullptr) return true;
  const int file = ::open(name, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0 || ::ftruncate(file, kMost) != 0) std::abort();
  void* const map = ::mmap(nullptr, kMost, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (map == MAP_FAILED) std::abort();
  reached = static_cast<unsigned char*>(map);
  ::close(file);
  return true;
}
// Stands before whatever a source initialises.
inline const bool begun = Begin();

constexpr bool On(unsigned change) {
  if (std::is_constant_evaluated()) return false;
  reached[change] = 1;
  return change == awake;
}

enum class Order { kLess, kGreater, kLessEqual, kGreaterEqual, kEqual, kUnequal };
constexpr Order Contrary(Order order) {
  constexpr Order kOf[] = {Order::kGreater,   Order::kLess,    Order::kGreaterEqual,
                           Order::kLessEqual, Order::kUnequal, Order::kEqual};
  return kOf[static_cast<int>(order)];
}
constexpr Order WithItsEnd(Order order) {
  constexpr Order kOf[] = {Order::kLessEqual, Order::kGreaterEqual, Order::kLess,
                           Order::kGreater,   Order::kEqual,        Order::kUnequal};
  return kOf[static_cast<int>(order)];
}

template <Order order>
constexpr auto Plain(const auto& a, const auto& b) {
  if constexpr (order == Order::kLess) return a < b;
  if constexpr (order == Order::kGreater) return a > b;
  if constexpr (order == Order::kLessEqual) return a <= b;
  if constexpr (order == Order::kGreaterEqual) return a >= b;
  if constexpr (order == Order::kEqual) return a == b;
  if constexpr (order == Order::kUnequal) return a != b;
}

// An order as an argument: where types hang on a template, `.Compare<>` would need the word
// template.
template <Order order>
struct Is {};

// Left and right of an operator.
template <class A, class B>
struct Operands {
  A&& a;
  B&& b;

  // 0 is no change.
  template <Order order>
  constexpr auto Compare(Is<order>, unsigned contrary, unsigned bound) const {
    if constexpr (requires { Plain<Contrary(order)>(a, b); }) {
      if (contrary != 0 && On(contrary)) return Plain<Contrary(order)>(a, b);
    }
    if (bound != 0 && On(bound)) return Plain<WithItsEnd(order)>(a, b);
    return Plain<order>(a, b);
  }
  constexpr auto Add(unsigned change) const {
    using Sum = decltype(std::forward<A>(a) + std::forward<B>(b));
    if constexpr (requires { static_cast<Sum>(a - b); }) {
      if (On(change)) return static_cast<Sum>(a - b);
    }
    return std::forward<A>(a) + std::forward<B>(b);
  }
  constexpr auto Subtract(unsigned change) const {
    using Difference = decltype(std::forward<A>(a) - std::forward<B>(b));
    if constexpr (requires { static_cast<Difference>(a + b); }) {
      if (On(change)) return static_cast<Difference>(a + b);
    }
    return std::forward<A>(a) - std::forward<B>(b);
  }
};
template <class A, class B>
Operands(A&&, B&&) -> Operands<A, B>;

template <class B>
constexpr decltype(auto) AddTo(unsigned change, auto& a, B&& b) {
  if constexpr (requires { a -= b; }) {
    if (On(change)) return a -= b;
  }
  return a += std::forward<B>(b);
}
template <class B>
constexpr decltype(auto) SubtractFrom(unsigned change, auto& a, B&& b) {
  if constexpr (requires { a += b; }) {
    if (On(change)) return a += b;
  }
  return a -= std::forward<B>(b);
}
constexpr auto Negative(unsigned change, const auto& a) {
  using Number = decltype(-a);
  if constexpr (requires { static_cast<Number>(a); }) {
    if (On(change)) return static_cast<Number>(a);
  }
  return -a;
}
constexpr decltype(auto) Next(unsigned change, auto& a) {
  if constexpr (requires { --a; }) {
    if (On(change)) return --a;
  }
  return ++a;
}
constexpr decltype(auto) Previous(unsigned change, auto& a) {
  if constexpr (requires { ++a; }) {
    if (On(change)) return ++a;
  }
  return --a;
}
constexpr auto ThenNext(unsigned change, auto& a) {
  if constexpr (requires { a--; }) {
    if (On(change)) return a--;
  }
  return a++;
}
constexpr auto ThenPrevious(unsigned change, auto& a) {
  if constexpr (requires { a++; }) {
    if (On(change)) return a++;
  }
  return a--;
}

}  // namespace rmlcell::changes
