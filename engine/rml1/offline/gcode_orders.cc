#include "engine/rml1/offline/gcode_orders.h"

#include <algorithm>
#include <string_view>

#include "engine/rml1/offline/phrase_words.h"

namespace rmlcell::rml1 {
namespace {

constexpr double kInch_mm = 25.4;

// The row of a G or M word; null: it is not in the subset.
const GcodeRow* RowOf(const GcodeWord& word) {
  const auto row = std::ranges::find_if(kGcodeRows, [&](const GcodeRow& candidate) {
    return candidate.letter == word.letter && candidate.tenths == word.value * 10.0;
  });
  return row == kGcodeRows.end() ? nullptr : &*row;
}

// A word that moves or waits, of which a line has one.
bool SortMotion(const GcodeWord& word, GcodeUse use, Orders& orders, GcodeFindings& findings) {
  if (orders.moves_or_waits()) {
    findings.Refuse(ErrorCode::kRml1GcodeForm, "two words that move or wait in one line",
                    word.where);
    return false;
  }
  if (use == GcodeUse::kHome) {
    orders.home = true;
  } else if (use == GcodeUse::kDwell) {
    orders.dwell = true;
  } else {
    orders.motion = use;
  }
  return true;
}

// A G or M word. False: it is refused.
bool SortCode(const GcodeWord& word, const GcodeRow& row, Orders& orders, GcodeFindings& findings) {
  switch (row.use) {
    case GcodeUse::kRapid:
    case GcodeUse::kLine:
    case GcodeUse::kArcClockwise:
    case GcodeUse::kArcCounter:
    case GcodeUse::kHome:
    case GcodeUse::kDwell:
      return SortMotion(word, row.use, orders, findings);
    case GcodeUse::kAbsolute:
    case GcodeUse::kRelative:
      orders.relative = row.use == GcodeUse::kRelative;
      return true;
    case GcodeUse::kInch:
    case GcodeUse::kMetric:
      orders.unit_mm = row.use == GcodeUse::kInch ? kInch_mm : 1.0;
      return true;
    case GcodeUse::kPlaneXY:
      orders.plane = ArcPlane{};
      return true;
    case GcodeUse::kPlaneZX:
      orders.plane = ArcPlane{{'Z', 'X', 'Y'}, {'K', 'I'}};
      return true;
    case GcodeUse::kPlaneYZ:
      orders.plane = ArcPlane{{'Y', 'Z', 'X'}, {'J', 'K'}};
      return true;
    case GcodeUse::kDefault:
      return true;
    case GcodeUse::kIgnored:
      findings.Note(ErrorCode::kRml1GcodeIgnored, WordText(word),
                    WordText(word) + ", " + std::string(row.text), word.where);
      return true;
    case GcodeUse::kToolChange:
      orders.tool_change = &word;
      return true;
    case GcodeUse::kPause:
      orders.pause = true;
      return true;
    case GcodeUse::kEnd:
      orders.end = true;
      return true;
    case GcodeUse::kSpindleOn:
      orders.spindle_on = true;
      return true;
    case GcodeUse::kSpindleOff:
      orders.spindle_off = true;
      return true;
  }
  return false;
}

// A word of any other letter. False: it is refused.
bool SortValue(const GcodeWord& word, const GcodeBlock& block, Orders& orders,
               GcodeFindings& findings) {
  if (word.letter == 'T') {
    findings.Note(ErrorCode::kRml1GcodeIgnored, "T", "T, the tool is put in by hand", word.where);
    orders.tool = word.value;
    return true;
  }
  if (word.letter == 'O' && block.words.size() == 1) {
    findings.Note(ErrorCode::kRml1GcodeIgnored, "O", WordText(word) + ", the number of the program",
                  word.where);
    return true;
  }
  if (std::string_view("XYZIJKRFSPH").find(word.letter) == std::string_view::npos) {
    findings.Refuse(ErrorCode::kRml1GcodeWord, WordText(word), word.where);
    return false;
  }
  if (!orders.values.emplace(word.letter, &word).second) {
    findings.Refuse(ErrorCode::kRml1GcodeForm,
                    Told("word", {&word.letter, 1}) + " twice in one line", word.where);
    return false;
  }
  return true;
}

}  // namespace

const GcodeWord* Orders::AxisWord() const {
  for (const char letter : {'X', 'Y', 'Z', 'I', 'J', 'K', 'R'}) {
    if (const GcodeWord* word = Find(letter)) return word;
  }
  return nullptr;
}

std::optional<Orders> OrdersOf(const GcodeBlock& block, GcodeFindings& findings) {
  Orders orders;
  bool good = true;
  bool path_mode = false;    // G64 takes a P of its own
  bool tool_length = false;  // G43 takes an H
  for (const GcodeWord& word : block.words) {
    if (word.letter != 'G' && word.letter != 'M') {
      good = SortValue(word, block, orders, findings) && good;
      continue;
    }
    const GcodeRow* row = RowOf(word);
    if (row == nullptr) {
      findings.Refuse(ErrorCode::kRml1GcodeWord, WordText(word), word.where);
      good = false;
      continue;
    }
    path_mode = path_mode || (row->letter == 'G' && row->tenths == 640);
    tool_length = tool_length || (row->letter == 'G' && row->tenths == 430);
    good = SortCode(word, *row, orders, findings) && good;
  }
  if (const GcodeWord* p = orders.Find('P'); p != nullptr && !orders.dwell) {
    if (!path_mode) {
      findings.Refuse(ErrorCode::kRml1GcodeWord, WordText(*p) + " without G4", p->where);
      good = false;
    }
  }
  if (const GcodeWord* h = orders.Find('H'); h != nullptr && !tool_length) {
    findings.Refuse(ErrorCode::kRml1GcodeWord, WordText(*h) + " without G43", h->where);
    good = false;
  }
  return good ? std::optional(std::move(orders)) : std::nullopt;
}

Detail WordText(const GcodeWord& word) {
  return Told("word", std::string(1, word.letter) + ShortNumber(word.value, 6));
}

}  // namespace rmlcell::rml1
