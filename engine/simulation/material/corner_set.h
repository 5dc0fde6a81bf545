#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rmlcell::simulation {

// Vertices of a grid, to be gone through along its rows and columns: one bit each for both.
class CornerSet {
 public:
  CornerSet(std::size_t columns, std::size_t rows)
      : along_x_(columns, rows), along_y_(rows, columns) {}

  void Add(std::size_t column, std::size_t row) {
    along_x_.Add(row, column);
    along_y_.Add(column, row);
  }

  // Calls `visit` with each column in a row from `first` to `last`, and each row in a column.
  template <class Visit>
  void ForEachInRow(std::size_t row, std::size_t first, std::size_t last, Visit visit) const {
    along_x_.ForEach(row, first, last, [&](std::uint64_t bits, std::size_t at) {
      for (; bits != 0; bits &= bits - 1)
        visit(at + static_cast<std::size_t>(std::countr_zero(bits)));
    });
  }
  template <class Visit>
  void ForEachInColumn(std::size_t column, std::size_t first, std::size_t last, Visit visit) const {
    along_y_.ForEach(column, first, last, [&](std::uint64_t bits, std::size_t at) {
      for (; bits != 0; bits &= bits - 1)
        visit(at + static_cast<std::size_t>(std::countr_zero(bits)));
    });
  }
  std::size_t CountInRow(std::size_t row, std::size_t first, std::size_t last) const {
    return along_x_.Count(row, first, last);
  }
  std::size_t CountInColumn(std::size_t column, std::size_t first, std::size_t last) const {
    return along_y_.Count(column, first, last);
  }

 private:
  class Lines {
   public:
    Lines(std::size_t length, std::size_t count)
        : words_((length + 63) / 64), bits_(words_ * count) {}
    void Add(std::size_t line, std::size_t at) {
      bits_[line * words_ + at / 64] |= std::uint64_t{1} << at % 64;
    }
    // With 64 bits at a time and the place of the first of them.
    template <class Visit>
    void ForEach(std::size_t line, std::size_t first, std::size_t last, Visit visit) const {
      const std::uint64_t* const words = &bits_[line * words_];
      for (std::size_t word = first / 64; word <= last / 64; ++word) {
        std::uint64_t bits = words[word];
        if (word == first / 64) bits &= ~std::uint64_t{0} << first % 64;
        if (word == last / 64) bits &= ~std::uint64_t{0} >> (63 - last % 64);
        visit(bits, 64 * word);
      }
    }
    std::size_t Count(std::size_t line, std::size_t first, std::size_t last) const {
      std::size_t count = 0;
      ForEach(line, first, last, [&](std::uint64_t bits, std::size_t) {
        count += static_cast<std::size_t>(std::popcount(bits));
      });
      return count;
    }

   private:
    std::size_t words_;  // of a line
    std::vector<std::uint64_t> bits_;
  };

  Lines along_x_;
  Lines along_y_;
};

}  // namespace rmlcell::simulation
