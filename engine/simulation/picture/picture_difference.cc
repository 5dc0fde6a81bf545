#include "engine/simulation/picture/picture_difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "engine/core/number_text.h"
#include "engine/simulation/picture/picture_panel.h"
#include "engine/simulation/picture/svg_shapes.h"
#include "engine/simulation/picture/text_width.h"

namespace rmlcell::simulation {
namespace {

constexpr double kDifferenceHeader = 92.0;
constexpr double kDifferenceColumn = 330.0;  // beside the panels
constexpr double kDifferenceFooter = 36.0;
constexpr double kCaption = 40.0;  // above the panels of the difference alone
constexpr int kDifferenceWidthMin = 720;
constexpr std::size_t kDifferenceTitleMax = 40;  // characters of one title that fit
constexpr double kCloserBelow = 0.35;  // a difference this much smaller than the path gets panels
constexpr std::size_t kDotsShown = 2000;  // of a kind, in a panel

// Told apart by colour, by dashes and by width: for eyes that see no red, and for black and white.
struct Look {
  std::string_view name;
  std::string_view cut;
  std::string_view dashes;
  std::string_view travel;
};
constexpr Look kCommon{"common", "#9aa7b2", "", "#cfd6dc"};
constexpr Look kRemoved{"removed", "#c92a2a", "7 4", "#e59a9a"};
constexpr Look kAdded{"added", "#1864ab", "", "#8bb4dc"};

std::string Colour(std::string_view attribute, std::string_view colour) {
  return std::string(attribute) + "=\"" + std::string(colour) + '"';
}

class DifferencePage {
 public:
  DifferencePage(const ComparedPath& before, const ComparedPath& after,
                 const machine::MachineShape& shape, const std::vector<ComparedFigure>& figures,
                 const PictureOptions& options, std::size_t elements_max,
                 const std::string& machine)
      : before_(before),
        after_(after),
        shape_(shape),
        figures_(figures),
        machine_(machine),
        difference_(Compare(before.path, after.path)) {
    width_ = std::clamp(options.width_px, kDifferenceWidthMin, kPageWidthMax);
    machine::Box all = before.path.box(), cut = before.path.cut_box();
    all.Add(after.path.box());
    cut.Add(after.path.cut_box());
    const double panels_width =
        width_ - 2.0 * kPageMargin - kRulerLeft - kDifferenceColumn - kColumnGap;
    const ScreenStrip strip{kPageMargin + kRulerLeft, kDifferenceHeader + kPageMargin,
                            panels_width};
    const machine::Box shown = BoxToShow(all, cut, shape.travel);
    zero_text_ = ZeroText(options, shape);
    whole_ = LayOut(FramesOf(options, shape), shown, strip, ZeroOf(options, shape));
    bottom_ = strip.y + whole_.height + kRulerBelow;

    machine::Box changed = difference_.removed.box();
    changed.Add(difference_.added.box());
    if (!changed.empty() && changed.diagonal_mm() < kCloserBelow * shown.diagonal_mm()) {
      closer_y_ = bottom_ + kCaption;
      std::vector<ViewFrame> frames = {FrameOf(PictureView::kXY, options.direction)};
      if (shape.five_axis) frames.push_back(FrameOf(PictureView::kXZ, options.direction));
      closer_ = LayOut(frames, BoxToShow(changed, {}, {}), {strip.x, closer_y_, panels_width},
                       ZeroOf(options, shape));
      bottom_ = closer_y_ + closer_.height + kRulerBelow;
    }
    const std::size_t panels = whole_.panels.size() + closer_.panels.size();
    elements_max_ = std::max<std::size_t>(elements_max / (3 * panels), 1);
    column_x_ = width_ - kPageMargin - kDifferenceColumn;
  }

  std::string Svg() {
    DrawHeader();
    int id = 0;
    for (const Panel& panel : whole_.panels) DrawOne(panel, ++id);
    if (!closer_.panels.empty()) {
      AppendText(body_, {kPageMargin + kRulerLeft, closer_y_ - 26.0}, "Where they differ, closer",
                 {.size = 15.0, .bold = true});
    }
    for (const Panel& panel : closer_.panels) DrawOne(panel, ++id);
    const double height = std::ceil(std::max(bottom_, DrawColumn(kDifferenceHeader + kPageMargin)) +
                                    kDifferenceFooter);
    AppendText(body_, {kPageMargin, height - 14.0}, zero_text_, {.size = 11.0, .colour = kFaint});
    return Opening(height) + body_ + "</svg>\n";
  }

 private:
  std::string Title() const { return before_.title + " → " + after_.title; }

  std::string Opening(double height) const {
    std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    out += "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + Pixels(width_) + "\" height=\"" +
           Pixels(height) + "\" viewBox=\"0 0 " + Pixels(width_) + ' ' + Pixels(height) +
           "\" font-family=\"Inter, 'Helvetica Neue', Arial, 'Liberation Sans', sans-serif\">\n";
    out += "<title>" + XmlText(Title()) + "</title>\n";
    out += "<desc>" + XmlText(Summary()) + "</desc>\n";
    AppendRect(out, {0, 0, static_cast<double>(width_), height}, Colour("fill", "#f7f9fa"));
    return out;
  }

  static std::string Lengths(const PathShare& part) {
    return FixedText(part.cut_mm, 3) + " mm cut, " + FixedText(part.travel_mm, 3) + " mm travel";
  }

  std::string Summary() const {
    return "removed " + Lengths(difference_.removed) + "; added " + Lengths(difference_.added) +
           "; common " + Lengths(difference_.common);
  }

  bool same_path() const {
    return difference_.removed.elements.empty() && difference_.added.elements.empty();
  }

  void DrawHeader() {
    AppendRect(body_, {0, 0, static_cast<double>(width_), kDifferenceHeader},
               Colour("fill", "#ffffff"));
    AppendLine(body_, {0, kDifferenceHeader}, {static_cast<double>(width_), kDifferenceHeader},
               Colour("stroke", kRule) + " stroke-width=\"1\"");
    const TextStyle large{.size = 26.0, .bold = true};
    const std::string arrow = "  →  ";
    const double room = width_ - 2.0 * kPageMargin - TextWidth(arrow, large);
    // What the one leaves the other may have; where both are long, half.
    const auto room_beside = [&](const std::string& other) {
      return std::max(0.5 * room, room - TextWidth(other, large));
    };
    AppendText(body_, {kPageMargin, 44.0},
               Fitted(before_.title, room_beside(after_.title), large) + arrow +
                   Fitted(after_.title, room_beside(before_.title), large),
               large);
    const bool whole = before_.note.empty() && after_.note.empty();
    const char* same =
        whole ? "both run along the same path" : "the same path, as far as both of them ran";
    AppendText(body_, {kPageMargin, 70.0},
               same_path() ? same : "removed: the first alone runs there; added: the second alone",
               {.size = 14.0, .colour = kFaint});
    const TextStyle small{.size = 12.0, .colour = kFaint};
    if (!machine_.empty()) {
      AppendText(body_, {kPageMargin, 86.0}, Fitted(machine_, width_ - 2.0 * kPageMargin, small),
                 small);
    }
  }

  void DrawOne(const Panel& panel, int id) {
    BeginPanel(shape_, panel, id, body_);
    DrawPart(difference_.common, kCommon, panel);
    DrawPart(difference_.removed, kRemoved, panel);
    DrawPart(difference_.added, kAdded, panel);
    EndPanel(panel, !before_.path.moved() && !after_.path.moved(), body_);
  }

  void DrawPart(const PathShare& part, const Look& look, const Panel& panel) {
    body_ += "<g class=\"" + std::string(look.name) + "\">\n";
    DrawPath({.elements = part.elements,
              .circles = part.circles,
              .cut = look.cut,
              .cut_dashes = look.dashes,
              .travel = look.travel},
             panel, {}, elements_max_, body_);
    const std::size_t stride = part.dots.size() / kDotsShown + 1;
    for (std::size_t i = 0; i < part.dots.size(); i += stride) {
      DrawDot(panel.Project(part.dots[i].at), look);
    }
    body_ += "</g>\n";
  }

  void DrawDot(ScreenPoint at, const Look& look) {
    const bool removed = !look.dashes.empty();
    AppendCircle(body_, at, 3.6,
                 removed ? "fill=\"none\" stroke-width=\"1.4\" " + Colour("stroke", look.cut)
                         : "stroke=\"#ffffff\" stroke-width=\"0.8\" " + Colour("fill", look.cut));
  }

  void Heading(double y, std::string_view text) {
    AppendText(body_, {column_x_, y}, text, {.size = 13.0, .colour = kFaint, .bold = true});
    AppendLine(body_, {column_x_, y + 7.0}, {column_x_ + kDifferenceColumn, y + 7.0},
               Colour("stroke", kRule) + " stroke-width=\"1\"");
  }

  // Legend, figures and notes, from `y` on; returns where they end.
  double DrawColumn(double y) {
    y = DrawLegend(y + 10.0);
    y = DrawFigures(y + 40.0);
    return DrawNotes(y + 14.0);
  }

  double DrawLegend(double y) {
    Heading(y, "Legend");
    y += 30.0;
    const std::array rows = {std::pair(&kRemoved, &difference_.removed),
                             std::pair(&kAdded, &difference_.added),
                             std::pair(&kCommon, &difference_.common)};
    for (const auto& [look, part] : rows) {
      std::string style = Colour("stroke", look->cut) + " stroke-width=\"2.2\"";
      if (!look->dashes.empty()) style += ' ' + Colour("stroke-dasharray", look->dashes);
      AppendLine(body_, {column_x_, y - 7.0}, {column_x_ + 44.0, y - 7.0}, style);
      AppendLine(body_, {column_x_, y + 1.0}, {column_x_ + 44.0, y + 1.0},
                 Colour("stroke", look->travel) + " stroke-width=\"1\" stroke-dasharray=\"5 3.5\"");
      AppendText(body_, {column_x_ + 58.0, y}, look->name, {.size = 14.0, .bold = true});
      AppendText(body_, {column_x_ + kDifferenceColumn, y}, Lengths(*part),
                 {.size = 11.5, .colour = kFaint, .anchor = "end"});
      y += 28.0;
    }
    AppendText(body_, {column_x_, y}, "upper line: cut; lower line: travel; dots: pierces, plunges",
               {.size = 11.0, .colour = kFaint});
    return y;
  }

  double DrawFigures(double y) {
    if (figures_.empty()) return y;
    Heading(y, "Figures");
    y += 26.0;
    for (const ComparedFigure& figure : figures_) {
      std::string name = figure.name;
      std::ranges::replace(name, '_', ' ');
      const bool same = figure.before == figure.after;
      AppendText(body_, {column_x_, y}, name, {.size = 13.0, .colour = kFaint});
      const auto number = [&](double of) {
        return figure.unit.empty() ? FixedText(of, 0) : TrimmedText(of, 3);
      };
      const std::string value = number(figure.before) + (same ? "" : " → " + number(figure.after)) +
                                (figure.unit.empty() ? "" : " " + figure.unit);
      AppendText(body_, {column_x_ + kDifferenceColumn, y}, value,
                 {.size = 13.0, .anchor = "end", .bold = !same});
      y += 20.0;
    }
    return y;
  }

  double DrawNotes(double y) {
    const auto note = [&](std::string_view text) {
      AppendText(body_, {column_x_, y}, text, {.size = 12.0, .colour = "#b4540a"});
      y += 18.0;
    };
    for (const ComparedPath* path : {&before_, &after_}) {
      if (!path->note.empty())
        note(Shortened(path->title, kDifferenceTitleMax) + ": " + path->note);
    }
    if (before_.path.tolerance_mm() > 0.0 || after_.path.tolerance_mm() > 0.0) {
      note("drawn coarser: the program is very long");
    }
    if (!difference_.exact) note("not all of the paths could be compared");
    return y;
  }

  const ComparedPath& before_;
  const ComparedPath& after_;
  const machine::MachineShape& shape_;
  const std::vector<ComparedFigure>& figures_;
  const std::string& machine_;
  PathDifference difference_;
  int width_ = 0;
  std::string_view zero_text_;
  PanelLayout whole_;
  PanelLayout closer_;
  double closer_y_ = 0.0;
  double bottom_ = 0.0;
  std::size_t elements_max_ = 0;
  double column_x_ = 0.0;
  std::string body_;
};

}  // namespace

std::string PictureOfDifference(const ComparedPath& before, const ComparedPath& after,
                                const machine::MachineShape& shape,
                                const std::vector<ComparedFigure>& figures,
                                const PictureOptions& options, std::size_t elements_max,
                                const std::string& machine) {
  return DifferencePage(before, after, shape, figures, options, elements_max, machine).Svg();
}

}  // namespace rmlcell::simulation
