#include "tests/engine/simulation/xml_check.h"

#include <set>
#include <vector>

namespace rmlcell::simulation {
namespace {

bool IsNameByte(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == ':' || c == '_';
}
bool IsBlank(char c) { return c == ' ' || c == '\n'; }

class Checker {
 public:
  explicit Checker(std::string_view left) : left_(left) {}

  std::string Run() {
    const std::string_view declaration = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    if (left_.starts_with(declaration)) left_.remove_prefix(declaration.size());
    while (fault_.empty() && !left_.empty()) {
      if (left_.front() == '<') {
        Tag();
      } else {
        Text();
      }
    }
    if (fault_.empty() && !open_.empty()) fault_ = "not closed: " + open_.back();
    if (fault_.empty() && roots_ != 1) fault_ = "roots: " + std::to_string(roots_);
    return fault_;
  }

 private:
  std::string_view Name() {
    std::size_t length = 0;
    while (length < left_.size() && IsNameByte(left_[length])) ++length;
    const std::string_view name = left_.substr(0, length);
    left_.remove_prefix(length);
    return name;
  }

  bool Take(std::string_view what) {
    if (!left_.starts_with(what)) return false;
    left_.remove_prefix(what.size());
    return true;
  }

  void Blanks() {
    while (!left_.empty() && IsBlank(left_.front())) left_.remove_prefix(1);
  }

  // Up to one of `ends`.
  void Characters(std::string_view ends) {
    while (fault_.empty() && !left_.empty() && ends.find(left_.front()) == std::string_view::npos) {
      const auto byte = static_cast<unsigned char>(left_.front());
      if (byte < 0x20 && byte != '\n') fault_ = "control character";
      if (byte == '<') fault_ = "bare <";
      if (byte == '&') {
        bool known = false;
        for (const std::string_view entity : {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"}) {
          known = known || left_.starts_with(entity);
        }
        if (!known) fault_ = "bare &";
      }
      left_.remove_prefix(Utf8Length());
    }
  }

  std::size_t Utf8Length() {
    const auto lead = static_cast<unsigned char>(left_.front());
    const std::size_t length = lead < 0x80 ? 1 : lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if ((lead >= 0x80 && lead < 0xC2) || lead > 0xF4 || left_.size() < length) {
      fault_ = "not UTF-8";
      return 1;
    }
    for (std::size_t i = 1; i < length; ++i) {
      if ((static_cast<unsigned char>(left_[i]) & 0xC0u) != 0x80u) fault_ = "not UTF-8";
    }
    return length;
  }

  void Text() {
    if (open_.empty() && !IsBlank(left_.front())) fault_ = "text outside the root";
    Characters("<");
  }

  void Tag() {
    left_.remove_prefix(1);
    if (Take("/")) {
      const std::string name(Name());
      if (open_.empty() || open_.back() != name) fault_ = "closes " + name;
      if (!open_.empty()) open_.pop_back();
      if (!Take(">")) fault_ = "end tag not closed";
      return;
    }
    const std::string name(Name());
    if (name.empty()) fault_ = "tag without name";
    if (open_.empty()) ++roots_;
    std::set<std::string_view> attributes;
    for (;;) {
      Blanks();
      if (!fault_.empty() || Take("/>")) return;
      if (Take(">")) {
        open_.push_back(name);
        return;
      }
      const std::string_view attribute = Name();
      if (attribute.empty() || !attributes.insert(attribute).second)
        fault_ = "attribute in " + name;
      if (!Take("=\"")) fault_ = "attribute without value in " + name;
      Characters("\"");
      if (!Take("\"")) fault_ = "value not closed in " + name;
    }
  }

  std::string_view left_;
  std::vector<std::string> open_;
  int roots_ = 0;
  std::string fault_;
};

}  // namespace

std::string XmlFault(std::string_view document) { return Checker(document).Run(); }

std::size_t CountOf(std::string_view text, std::string_view what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string_view::npos;
       at = text.find(what, at + 1)) {
    ++count;
  }
  return count;
}

}  // namespace rmlcell::simulation
