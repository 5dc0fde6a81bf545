// The facts of an example, as rml1.md 0.1 defines them.
#include <cmath>
#include <functional>
#include <map>
#include <sstream>

#include "engine/core/number_text.h"
#include "tests/conformance/rml1_example.h"

namespace rmlcell::rml1::conformance {
namespace {

using Event = Observed::Event;
using Kind = Event::Kind;

constexpr double kUnitTolerance = 0.01;
constexpr double kAngleTolerance = 0.001;

std::vector<int> Integers(const std::string& text) {
  std::vector<int> numbers;
  if (text == "empty") return numbers;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) numbers.push_back(std::stoi(part));
  return numbers;
}

std::string Print(const std::vector<int>& numbers) {
  std::string text;
  for (const int number : numbers) {
    if (!text.empty()) text += ',';
    text += std::to_string(number);
  }
  return text.empty() ? "empty" : text;
}

// "(1,2,3)", "(1,2,3,4)" or "[dwell 100]".
Event ParseEvent(const std::string& text) {
  Event event;
  if (text[0] == '(') {
    std::istringstream in(text.substr(1, text.size() - 2));
    double* const parts[] = {&event.x, &event.y, &event.z, &event.a};
    std::size_t i = 0;
    for (std::string part; std::getline(in, part, ',') && i < 4; ++i) {
      *parts[i] = ParseDouble(part).value();
    }
    return event;
  }
  static const std::map<std::string, Kind> kKinds = {{"spin", Kind::kSpin},
                                                     {"rpm", Kind::kRpm},
                                                     {"stop", Kind::kStop},
                                                     {"dwell", Kind::kDwell},
                                                     {"pause", Kind::kPause}};
  std::istringstream in(text.substr(1, text.size() - 2));
  std::string word;
  in >> word;
  event.kind = kKinds.at(word);
  in >> event.number;
  return event;
}

std::vector<Event> ParseEvents(const std::string& text) {
  std::vector<Event> events;
  if (text == "empty") return events;
  for (std::size_t at = text.find_first_of("(["); at != std::string::npos;) {
    const std::size_t end = text.find_first_of(")]", at);
    events.push_back(ParseEvent(text.substr(at, end - at + 1)));
    at = text.find_first_of("([", end);
  }
  return events;
}

bool Near(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance; }

bool Same(const Event& a, const Event& b) {
  return a.kind == b.kind && a.number == b.number && Near(a.x, b.x, kUnitTolerance) &&
         Near(a.y, b.y, kUnitTolerance) && Near(a.z, b.z, kUnitTolerance) &&
         Near(a.a, b.a, kAngleTolerance);
}

bool Same(const std::vector<Event>& a, const std::vector<Event>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!Same(a[i], b[i])) return false;
  }
  return true;
}

std::vector<Event> Moves(const Observed& observed) {
  std::vector<Event> moves;
  for (const Event& event : observed.trace) {
    if (event.kind == Kind::kMove) moves.push_back(event);
  }
  return moves;
}

// Collects what is not as it should be.
class Checker {
 public:
  Checker(const Observed& observed) : seen_(observed) {}

  void Check(const std::string& fact) {
    const std::size_t blank = fact.find(' ');
    const std::string word = fact.substr(0, blank);
    const std::string rest = blank == std::string::npos ? "" : fact.substr(blank + 1);
    if (word == "err" || word == "log" || word == "com" || word == "comlog") {
      CheckErrors(word, rest);
    } else if (word == "moves" || fact == "no moves") {
      const std::vector<Event> wanted = ParseEvents(word == "moves" ? rest : "empty");
      Expect(Same(Moves(seen_), wanted), fact, conformance::Print(Moves(seen_)));
    } else if (word == "trace") {
      Expect(Same(seen_.trace, ParseEvents(rest)), fact, conformance::Print(seen_.trace));
    } else if (word == "feeds") {
      CheckFeeds(fact, rest);
    } else {
      CheckState(fact, word, rest);
    }
  }

  void CheckImplied() {
    if (!err_stated_ && !log_stated_) Expect(seen_.err == 0, "err 0 (implied)", seen_.err);
    if (!err_stated_ && log_stated_) {
      const bool any = seen_.log.size() > seen_.log_cleared_at;
      const int wanted = any ? seen_.log[seen_.log_cleared_at] : 0;
      Expect(seen_.err == wanted, "err " + std::to_string(wanted) + " (by the log)", seen_.err);
    }
    if (!com_stated_) Expect(seen_.com == 0, "com 0 (implied)", seen_.com);
  }

  std::vector<std::string> Take() { return std::move(violations_); }

 private:
  void Expect(bool holds, const std::string& wanted, const std::string& got) {
    if (!holds) violations_.push_back("expected " + wanted + "; got " + got);
  }
  void Expect(bool holds, const std::string& wanted, double got) {
    Expect(holds, wanted, ShortestText(got));
  }

  void CheckErrors(const std::string& word, const std::string& rest) {
    if (word == "err") {
      err_stated_ = true;
      Expect(seen_.err == std::stoi(rest), "err " + rest, seen_.err);
    } else if (word == "log") {
      log_stated_ = true;
      Expect(seen_.log == Integers(rest), "log " + rest, Print(seen_.log));
    } else if (word == "com") {
      com_stated_ = true;
      Expect(seen_.com == std::stoi(rest), "com " + rest, seen_.com);
    } else {
      Expect(seen_.comlog == Integers(rest), "comlog " + rest, Print(seen_.comlog));
    }
  }

  void CheckFeeds(const std::string& fact, const std::string& rest) {
    std::istringstream in(rest);
    std::string got;
    bool same = true;
    for (const Event& move : Moves(seen_)) {
      double wanted = -1.0;
      in >> wanted;
      same = same && Near(move.feed, wanted, 1e-9);
      got += ShortestText(move.feed) + " ";
    }
    double surplus = 0.0;
    Expect(same && !(in >> surplus), fact, got);
  }

  void CheckState(const std::string& fact, const std::string& word, const std::string& rest) {
    const auto number = [&](double value) {
      Expect(Near(value, ParseDouble(rest).value(), kUnitTolerance / 10.0), fact, value);
    };
    const auto flag = [&](bool value) { Expect(value, fact, "the opposite"); };
    const auto point = [&](const Event& place) {
      Expect(Same(place, ParseEvent(rest)), fact, conformance::Print(place));
    };
    if (fact == "abs" || fact == "rel") return Expect(seen_.mode == fact, fact, seen_.mode);
    if (fact == "up" || fact == "down") return Expect(seen_.tool == fact, fact, seen_.tool);
    if (word == "VS") return number(seen_.vs);
    if (word == "VZ") return number(seen_.vz);
    if (word == "DW") return number(seen_.dwell_ms);
    if (word == "Z0") return number(seen_.z0);
    if (word == "Z1") return number(seen_.z1);
    if (word == "Z2") return number(seen_.z2);
    if (word == "rpm") return number(seen_.rpm);
    if (word == "MC") return flag(seen_.rotation == (rest == "on"));
    if (word == "spindle") return flag(seen_.spindle_on == (rest == "on"));
    if (word == "at") return point(seen_.at);
    if (word == "logical") return point(seen_.logical);
    if (fact == "paused") return flag(seen_.paused);
    if (fact == "not paused") return flag(!seen_.paused);
    if (fact == "pending") return flag(seen_.pending.value_or(true));
    if (fact == "nothing pending") return flag(!seen_.pending.value_or(false));
    if (word == "ESC.M") return Expect(seen_.esc_m == rest, fact, seen_.esc_m);
    if (word == "ESC.T") return Expect(seen_.esc_t == rest, fact, seen_.esc_t);
    violations_.push_back("unknown fact: " + fact);
  }

  const Observed& seen_;
  bool err_stated_ = false;
  bool log_stated_ = false;
  bool com_stated_ = false;
  std::vector<std::string> violations_;
};

}  // namespace

std::string Print(const Event& event) {
  std::ostringstream out;
  switch (event.kind) {
    case Kind::kMove:
      out << '(' << TrimmedText(event.x, 3) << ',' << TrimmedText(event.y, 3) << ','
          << TrimmedText(event.z, 3) << ',' << TrimmedText(event.a, 3) << ')';
      break;
    case Kind::kSpin:
      out << "[spin " << event.number << ']';
      break;
    case Kind::kRpm:
      out << "[rpm " << event.number << ']';
      break;
    case Kind::kStop:
      out << "[stop]";
      break;
    case Kind::kDwell:
      out << "[dwell " << event.number << ']';
      break;
    case Kind::kPause:
      out << "[pause]";
      break;
  }
  return out.str();
}

std::string Print(const std::vector<Event>& trace) {
  std::string text;
  for (const Event& event : trace) text.append(Print(event)).append(" ");
  return text.empty() ? "empty" : text;
}

std::vector<std::string> Violations(const Example& example, const Observed& observed) {
  Checker checker(observed);
  std::istringstream in(example.facts);
  for (std::string fact; std::getline(in, fact, ';');) {
    const std::size_t begin = fact.find_first_not_of(' ');
    checker.Check(fact.substr(begin, fact.find_last_not_of(' ') - begin + 1));
  }
  checker.CheckImplied();
  return checker.Take();
}

}  // namespace rmlcell::rml1::conformance
