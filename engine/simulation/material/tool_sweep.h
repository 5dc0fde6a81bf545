#pragma once

#include <array>
#include <optional>
#include <span>

#include "engine/simulation/material/height_field.h"
#include "engine/simulation/material/swept_rows.h"

namespace rmlcell::simulation {

// What a tool leaves over the cells of a field on a straight move, in pieces of rows:
//
//   for (auto pieces = sweep.Next(); !pieces.empty(); pieces = sweep.Next()) ...
//
// No two pieces have a cell in common. They come several at a time, so that the heights of a field
// for some rows are on their way from memory while those of others are compared. The field must
// outlive it.
class ToolSweep {
 public:
  // Of the cutting end.
  ToolSweep(const HeightField& field, const MillTool& tool, const motion::MachinePoint& from,
            const motion::MachinePoint& to, HeightField::Rows rows);

  // Of what goes along above it and is as wide as `radius_mm` from `raised_mm` above its lowest
  // point on: where the tool has not cut before.
  struct Collar {
    double radius_mm = 0.0;
    double raised_mm = 0.0;
  };
  ToolSweep(const HeightField& field, const Collar& collar, const MillTool& tool,
            const motion::MachinePoint& from, const motion::MachinePoint& to,
            HeightField::Rows rows);

  static constexpr std::size_t kPieceCells = 64;  // more than most tools come over in a row
  struct Piece {
    std::size_t cell;                // the first one, as HeightField::heights has it
    std::span<const float> heights;  // the least ones of the tool's surface from there on
  };
  // Valid until the next call; none when that was all.
  std::span<const Piece> Next();

  // A flat tool that does not rise or sink on its way leaves one height, and its cells are told in
  // this way, too; no cells: that was all.
  bool is_level() const { return surface_ == Surface::kLevel; }
  float level() const { return level_.front(); }
  struct LevelPiece {
    std::size_t cell = 0;
    std::size_t count = 0;  // up to kPieceCells
  };
  LevelPiece NextLevel();

 private:
  enum class Surface {
    kLevel,
    kFlatUp,
    kFlatDown,
    kBall,
    kLevelBall,
    kPlungedBall,
    kVee,
    kLevelVee,
    kCollar
  };
  static Surface SurfaceOf(const MillTool& tool, const ToolPass& pass);
  ToolSweep(const HeightField& field, const MillTool& tool, const ToolPass& pass,
            HeightField::Rows rows);
  ToolSweep(const HeightField& field, const ToolPass& pass, Surface surface,
            HeightField::Rows rows);

  bool ToNextRow();
  template <class Least>
  std::span<const Piece> NextBy(Least least);
  template <class Least>
  void WorkOut(std::size_t row, std::size_t begin, std::size_t end, Least least, float* heights);
  const double* PlacesOf(std::size_t begin, std::size_t end);

  const HeightField& field_;
  ToolPass pass_;
  Surface surface_;
  Collar collar_;
  double cutter_radius_mm_ = 0.0;

  // How far some columns are from the start of the move: rows that follow need the same.
  static constexpr std::size_t kPlaces = 2048;  // 16 KiB, half of what is nearest to a processor
  std::array<double, kPlaces> places_;
  std::size_t first_place_ = 0;
  std::size_t end_place_ = 0;
  std::size_t leftmost_;  // columns that it comes over, about
  std::size_t rightmost_;

  SweptRows swept_;
  std::optional<SweptRows> stood_;  // of a flat tool on a slope: it leaves one height there
  std::size_t row_;
  std::size_t end_row_;
  SweptRows::Columns columns_;  // of rows that were found together
  SweptRows::Columns level_columns_;
  std::size_t found_rows_ = 0;
  std::size_t next_found_ = 0;

  // In the row, what has not been told: from one column to another, with those of one height.
  std::size_t column_ = 0;
  std::size_t level_begin_ = 0;
  std::size_t level_end_ = 0;
  std::size_t end_ = 0;

  std::array<float, kPieceCells> level_;
  static constexpr std::size_t kPieces = 16;
  static constexpr std::size_t kMoreWorkedOut = 3;
  using PieceHeights = std::array<float, kPieceCells + kMoreWorkedOut>;
  std::array<Piece, kPieces> pieces_;
  std::array<PieceHeights, kPieces> heights_;
};

}  // namespace rmlcell::simulation
