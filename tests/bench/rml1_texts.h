#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <string_view>

namespace rmlcell::bench {

// RML-1 as CAM systems write it, along a walk: segments of 0.05 to 2 mm, the heading changed by a
// normal of 0.35 rad, in units of 0.01 mm. The forms:
//   sets    Z x,y,z; a line each, as reliefs have them (the walk of the shared gen_programs.py)
//   pairs   PD x,y; a line each, with PU at every fiftieth
//   list    PD x,y x,y ... fifty pairs a command, parted by spaces
//   steps   PR dx dy; relative, parted by spaces
//   gcode   the walk of the sets in G-code, for a rival
class Rml1Walk {
 public:
  explicit Rml1Walk(std::string_view form) : form_(form) {
    text_ = form == "sets" ? "^IN;!MC1;V15.0;\n" : "IN;!MC1;VS15;!VZ15;!PZ-100,200;PA;\n";
    if (form == "steps") text_ += "PD0,0;";
    if (form == "gcode") text_ = "G21 G90 G94 G64 P0.01\nF1500\n";
  }

  static bool Knows(std::string_view form) {
    return form == "sets" || form == "pairs" || form == "list" || form == "steps";
  }

  std::string Text(int moves) {
    text_.reserve(text_.size() + static_cast<std::size_t>(moves) * 24);
    for (int k = 0; k < moves; ++k) Add(k);
    if (form_ == "list" && moves % kEach != 0) text_ += ";\n";
    if (form_ == "gcode") text_ += "M2\n";
    return std::move(text_);
  }

 private:
  static constexpr int kEach = 50;

  void Add(int k) {
    Go();
    if (form_ == "gcode") {
      text_ += "G1";
      PutMillimetres(" X", x_), PutMillimetres(" Y", y_), PutMillimetres(" Z", z_);
      text_ += '\n';
    } else if (form_ == "sets") {
      text_ += 'Z';
      Put(x_), Put(',', y_), Put(',', z_);
      text_ += ";\n";
    } else if (form_ == "pairs") {
      text_ += k % kEach == 0 ? "PU" : "PD";
      Put(x_), Put(',', y_);
      text_ += ";\n";
    } else if (form_ == "list") {
      text_ += k % kEach == 0 ? "PD" : " ";
      Put(x_), Put(',', y_);
      if (k % kEach == kEach - 1) text_ += ";\n";
    } else {
      text_ += "PR ";
      Put(std::round(x_) - std::round(from_x_)), Put(' ', std::round(y_) - std::round(from_y_));
      text_ += ";\n";
    }
  }

  void Go() {
    constexpr double kReach = 15000.0;
    from_x_ = x_;
    from_y_ = y_;
    heading_ += turn_(dice_);
    const double length = length_(dice_);
    x_ += length * std::cos(heading_);
    y_ += length * std::sin(heading_);
    z_ = std::clamp(z_ + rise_(dice_), -2000.0, 0.0);
    if (std::abs(x_) < kReach && std::abs(y_) < kReach) return;
    heading_ += std::acos(-1.0);
    x_ = std::clamp(x_, -kReach, kReach);
    y_ = std::clamp(y_, -kReach, kReach);
  }

  void PutMillimetres(std::string_view word, double units) {
    char room[24];
    text_ += word;
    text_.append(room, std::to_chars(room, room + sizeof room, std::round(units) / 100.0,
                                     std::chars_format::fixed, 3)
                           .ptr);
  }
  void Put(char before, double value) {
    text_ += before;
    Put(value);
  }
  void Put(double value) {
    char room[16];
    text_.append(room, std::to_chars(room, room + sizeof room, std::lround(value)).ptr);
  }

  std::string_view form_;
  std::string text_;
  std::mt19937_64 dice_{12345};
  std::normal_distribution<double> turn_{0.0, 0.35};
  std::uniform_real_distribution<double> length_{5.0, 200.0};
  std::uniform_real_distribution<double> rise_{-10.0, 10.0};
  double x_ = 0.0;
  double y_ = 0.0;
  double z_ = 0.0;
  double from_x_ = 0.0;
  double from_y_ = 0.0;
  double heading_ = 0.0;
};

}  // namespace rmlcell::bench
