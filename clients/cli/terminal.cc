#include "clients/cli/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "engine/core/hex.h"
#include "engine/core/number_text.h"

namespace rmlcell::cli {
namespace {

bool ColourOn(int descriptor) {
  const char* no_colour = std::getenv("NO_COLOR");
  return ::isatty(descriptor) != 0 && (no_colour == nullptr || *no_colour == 0);
}

std::string_view CodeOf(Colour colour) {
  switch (colour) {
    case Colour::kRed:
      return "31";
    case Colour::kYellow:
      return "33";
    case Colour::kGreen:
      return "32";
    case Colour::kBlue:
      return "36";
    case Colour::kDim:
      return "2";
    case Colour::kBold:
      return "1";
    case Colour::kPlain:
      break;
  }
  return "0";
}

// Characters, not bytes: one for each byte that does not continue another.
std::size_t Width(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

bool ColourOnOutput() { return ColourOn(STDOUT_FILENO); }
bool ColourOnErrors() { return ColourOn(STDERR_FILENO); }

std::string Paint(std::string_view text, Colour colour, bool on) {
  if (!on || colour == Colour::kPlain) return std::string(text);
  return "\x1b[" + std::string(CodeOf(colour)) + "m" + std::string(text) + "\x1b[0m";
}

std::string Visible(std::string_view text) {
  std::string visible;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7F) {
      visible += c;
    } else {
      visible += "\\x" + HexByte(c);
    }
  }
  return visible;
}

void PrintRaw(std::string_view text) { std::fwrite(text.data(), 1, text.size(), stdout); }

void Print(std::string_view text) {
  PrintRaw(text);
  std::fputc('\n', stdout);
}

void Complain(std::string_view text) {
  const std::string line =
      Paint("rmlcell: ", Colour::kRed, ColourOnErrors()) + std::string(text) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

namespace {

// A title of 200 characters must not push the columns behind it out of sight.
constexpr std::size_t kCellMax = 60;

bool Continues(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }

// The first characters of a text that is wider, ended by an ellipsis; none is cut in two.
std::string CutToWidth(std::string text, std::size_t characters) {
  if (Width(text) <= characters) return text;
  std::size_t end = 0;
  for (std::size_t kept = 0; kept + 1 < characters; ++kept) {
    ++end;
    while (end < text.size() && Continues(text[end])) ++end;
  }
  return text.substr(0, end) + "…";
}

}  // namespace

namespace {

// What people wrote gives way; names, times and numbers would be of no use without their ends.
void Narrow(const std::vector<std::string>& heading, std::size_t line,
            std::vector<std::size_t>& columns) {
  constexpr std::size_t kLeast = 8;
  const auto title = std::ranges::find(heading, "TITLE");
  if (title == heading.end()) return;
  std::size_t all = 2 * (columns.size() - 1);
  for (const std::size_t column : columns) all += column;
  std::size_t& free = columns[static_cast<std::size_t>(title - heading.begin())];
  const std::size_t beyond = all - std::min(all, line);
  free = std::max(std::min(free, kLeast), free - std::min(free, beyond));
}

}  // namespace

std::size_t OutputWidth() {
  winsize size{};
  if (::isatty(STDOUT_FILENO) == 0 || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return 0;
  return size.ws_col;
}

std::string Table(std::vector<std::vector<std::string>> rows, std::size_t width) {
  for (auto& row : rows) {
    for (std::string& cell : row) cell = CutToWidth(Visible(cell), kCellMax);
  }
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], Width(row[i]));
  }
  if (width > 0 && !rows.empty()) {
    Narrow(rows.front(), width, widths);
    for (auto& row : rows) {
      for (std::size_t i = 0; i < row.size(); ++i)
        row[i] = CutToWidth(std::move(row[i]), widths[i]);
    }
  }
  std::string text;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::string line;
    for (std::size_t i = 0; i < rows[r].size(); ++i) {
      line += rows[r][i];
      if (i + 1 < rows[r].size()) line.append(widths[i] - Width(rows[r][i]) + 2, ' ');
    }
    text += (r == 0 ? Paint(line, Colour::kBold, ColourOnOutput()) : line) + "\n";
  }
  return text;
}

ProgressLine::~ProgressLine() { Clear(); }

void ProgressLine::Show(double share, std::string_view text) {
  if (::isatty(STDERR_FILENO) == 0) return;
  constexpr int kCells = 28;
  std::string bar;
  if (share >= 0.0) {
    const int filled = static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * kCells));
    for (int i = 0; i < kCells; ++i) bar += i < filled ? "█" : "░";
    bar += " " + std::to_string(static_cast<int>(share * 100.0)) + " %";
  } else {
    const int at = static_cast<int>(turn_++ % (2 * (kCells - 1)));
    const int place = at < kCells ? at : 2 * (kCells - 1) - at;
    for (int i = 0; i < kCells; ++i) bar += i == place ? "█" : "░";
  }
  std::fprintf(stderr, "\r\x1b[K%s  %.*s", bar.c_str(), static_cast<int>(text.size()), text.data());
  std::fflush(stderr);
  shown_ = true;
}

void ProgressLine::Leave(double share, std::string_view text) {
  Show(share, text);
  if (shown_) std::fputs("\n", stderr);
  shown_ = false;
}

void ProgressLine::Clear() {
  if (shown_) std::fputs("\r\x1b[K", stderr);
  shown_ = false;
}

std::string Fixed(double value, int decimals) { return FixedText(value, decimals); }

std::string Duration(double seconds) {
  if (!(seconds >= 0.0)) return "-";
  const auto whole = static_cast<std::int64_t>(seconds);
  const std::int64_t hours = whole / 3600;
  const std::int64_t minutes = whole / 60 % 60;
  const double rest = seconds - static_cast<double>(whole - whole % 60);
  std::string text;
  if (hours > 0) text += std::to_string(hours) + " h ";
  if (hours > 0 || minutes > 0) text += std::to_string(minutes) + " min ";
  return text + FixedText(rest, 3) + " s";
}

std::string Bytes(std::int64_t bytes) {
  if (bytes < 1000) return std::to_string(bytes) + " B";
  double value = static_cast<double>(bytes) / 1000.0;
  const char* unit = "kB";
  if (value >= 1000.0) {
    value /= 1000.0;
    unit = "MB";
  }
  return FixedText(value, 1) + " " + unit;
}

}  // namespace rmlcell::cli
