#include "engine/simulation/picture/picture_page.h"

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "engine/simulation/picture/picture_panel.h"
#include "engine/simulation/picture/svg_shapes.h"
#include "engine/simulation/picture/text_width.h"

namespace rmlcell::simulation {
namespace {

constexpr double kPictureHeader = 92.0;
constexpr double kPictureColumn = 282.0;  // beside the panels
constexpr double kPictureFooter = 30.0;
constexpr double kCycleTimeWidth = 110.0;  // of the two words and the gap before them
constexpr int kPictureWidthMin = 640;
constexpr int kThumbnailMin = 64;  // narrower ones are not worth a look

constexpr std::size_t kReasonsDrawn = 4;
constexpr std::size_t kReasonLine = 38;  // characters that fit beside the picture

struct VerdictPaint {
  std::string_view ground;
  std::string_view text;
};
VerdictPaint PaintOf(machine::Verdict verdict) {
  switch (verdict) {
    case machine::Verdict::kGood:
      return {"#e6f4ea", "#1e6b34"};
    case machine::Verdict::kDoubtful:
      return {"#fff3d1", "#7a4b00"};
    case machine::Verdict::kBad:
      return {"#fde8e8", "#b42318"};
  }
  return {"#fde8e8", "#b42318"};
}

// 99.9995 mm and more are told as 100.0 mm.
std::string Length(double mm) {
  return FixedText(mm, mm == 0.0 ? 0 : mm < 99.9995 ? 3 : 1) + " mm";
}

class PageWriter {
 public:
  PageWriter(const PathSketch& sketch, const machine::MachineShape& shape, const RunReport& report,
             const PictureOptions& options)
      : sketch_(sketch), shape_(shape), report_(report) {
    if (report.work_origin) shape_.work_origin = *report.work_origin;
    zero_ = ZeroOf(options, shape_);
    zero_text_ = ZeroText(options, shape_);
    width_ = std::clamp(options.width_px, kPictureWidthMin, kPageWidthMax);
    shown_px_ = options.width_px < kThumbnailMin ? width_ : std::min(options.width_px, width_);
    const std::vector<ViewFrame> frames = FramesOf(options, shape);
    depth_ = DepthOf(frames);
    const double panels_width =
        width_ - 2.0 * kPageMargin - kRulerLeft - kPictureColumn - kColumnGap;
    layout_ = LayOut(frames, BoxToShow(sketch, shape.travel),
                     {kPageMargin + kRulerLeft, kPictureHeader + kPageMargin, panels_width}, zero_);
    column_x_ = width_ - kPageMargin - kPictureColumn;
  }

  std::string Svg() {
    DrawHeader();
    DrawPanels();
    const double column_bottom = DrawColumn(kPictureHeader + kPageMargin);
    const double panels_bottom = kPictureHeader + kPageMargin + layout_.height + kRulerBelow;
    const double height = std::max(column_bottom, panels_bottom) + kPictureFooter + 6.0;
    DrawFooter(height);
    body_ += "</svg>\n";
    body_.insert(0, Opening(height));
    return std::move(body_);
  }

 private:
  // A mill seen from above tells depth by shade.
  DepthRange DepthOf(const std::vector<ViewFrame>& frames) const {
    constexpr double kFlat_mm = 0.01;
    const bool from_above = frames.size() == 1 && frames[0].upward == "Y";
    if (shape_.five_axis || !from_above) return {};
    double low = HUGE_VAL;
    double high = -HUGE_VAL;
    for (const SketchElement& element : sketch_.elements()) {
      if (!element.cuts || (element.skims && sketch_.skims_beside_cuts())) continue;
      low = std::min({low, element.from.z(), element.to.z()});
      high = std::max(high, std::min(element.from.z(), element.to.z()));
    }
    if (!(high - low > kFlat_mm)) return {};
    return {.low_mm = low, .high_mm = high, .shaded = true};
  }

  std::string Opening(double height) const {
    const double shown_height = std::ceil(height) * shown_px_ / width_;
    const std::string size = Pixels(shown_px_) + "\" height=\"" + Pixels(std::ceil(shown_height));
    std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    out +=
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + size + "\" viewBox=\"0 0 " +
        Pixels(width_) + ' ' + Pixels(std::ceil(height)) +
        "\" style=\"max-width:100%;height:auto\" font-family=\"Inter, 'Helvetica Neue', Arial, 'Liberation Sans', sans-serif\">\n";
    out += "<title>" + XmlText(TitleText()) + "</title>\n";
    out += "<desc>" + XmlText(Summary()) + "</desc>\n";
    AppendRect(out, {0, 0, static_cast<double>(width_), std::ceil(height)}, "fill=\"#f7f9fa\"");
    return out;
  }

  std::string TitleText() const { return report_.title.empty() ? "Toolpath" : report_.title; }

  bool completed() const { return report_.outcome.kind == machine::OutcomeKind::kCompleted; }

  std::string Summary() const {
    return "Cycle time " + DurationText(report_.cycle_time) + ", cut " +
           Length(report_.total.cut_mm) + ", travel " + Length(report_.total.travel_mm);
  }

  std::string OutcomeLine() const {
    std::string text(OutcomeText(report_.outcome.kind));
    std::replace(text.begin(), text.end(), '_', ' ');
    if (report_.outcome.code) text += "  " + CodeText(*report_.outcome.code);
    if (!completed()) {
      text += "  at " + std::to_string(report_.outcome.place.program) + '/' +
              std::to_string(report_.outcome.place.step);
    }
    return text;
  }

  void DrawHeader() {
    AppendRect(body_, {0, 0, static_cast<double>(width_), kPictureHeader}, "fill=\"#ffffff\"");
    AppendLine(body_, {0, kPictureHeader}, {static_cast<double>(width_), kPictureHeader},
               "stroke=\"#d3dae1\" stroke-width=\"1\"");
    const double right = width_ - kPageMargin;
    const std::string duration = DurationText(report_.cycle_time);
    const TextStyle large{.size = 26.0, .bold = true};
    AppendText(
        body_, {kPageMargin, 44.0},
        Fitted(TitleText(), right - kPageMargin - kTextGap - TextWidth(duration, large), large),
        large);
    const machine::MachineUsed& used = report_.machine;
    const machine::MachineFamily* family = families::FindFamily(report_.family);
    const std::string machine =
        family != nullptr ? machine::MachineTitle(*family, used.profile, used.named, used.own_name)
                          : report_.family;
    const double caption_width = right - kPageMargin - kCycleTimeWidth;
    const TextStyle caption{.size = 14.0, .colour = kFaint};
    AppendText(body_, {kPageMargin, 70.0}, Fitted(machine, caption_width, caption), caption);
    if (const std::string changes = used.ChangesText(); !changes.empty()) {
      const TextStyle small{.size = 12.0, .colour = kFaint};
      AppendText(body_, {kPageMargin, 86.0}, Fitted("changed: " + changes, caption_width, small),
                 small);
    }
    AppendText(body_, {right, 44.0}, duration, {.size = 26.0, .anchor = "end", .bold = true});
    AppendText(body_, {right, 70.0}, "cycle time",
               {.size = 14.0, .colour = kFaint, .anchor = "end"});
  }

  void DrawPanels() {
    const PanelContent content{.sketch = sketch_,
                               .shape = shape_,
                               .depth = depth_,
                               .completed = completed(),
                               .elements_max = kPictureElementsMax / layout_.panels.size()};
    int id = 0;
    for (const Panel& panel : layout_.panels) DrawPanel(content, panel, ++id, body_);
  }

  // Figures, legend and place, from `y` on; returns where they end.
  double DrawColumn(double y) {
    y = DrawVerdict(y);
    y = DrawFigures(y + 26.0);
    y = DrawLegend(y + 18.0);
    return DrawPlace(y + 18.0);
  }

  // The verdict and the end as a badge, and what makes it so.
  double DrawVerdict(double y) {
    const VerdictPaint paint = PaintOf(report_.judgement.verdict);
    const std::string text =
        std::string(machine::VerdictText(report_.judgement.verdict)) + ", " + OutcomeLine();
    AppendRect(body_, {column_x_, y, kPictureColumn, 30.0},
               "fill=\"" + std::string(paint.ground) + "\" rx=\"5\"");
    AppendText(body_, {column_x_ + 12.0, y + 20.0}, text,
               {.size = 14.0, .colour = paint.text, .bold = true});
    y += 30.0;
    std::size_t told = 0;
    for (const machine::Reason& reason : report_.judgement.reasons) {
      if (told++ == kReasonsDrawn) break;
      y += 6.0;
      for (const std::string& line : Wrapped(reason.said, kReasonLine)) {
        y += 16.0;
        AppendText(body_, {column_x_ + 12.0, y}, line,
                   {.size = 12.0, .colour = PaintOf(reason.verdict).text});
      }
    }
    if (report_.judgement.reasons.size() > kReasonsDrawn) {
      y += 22.0;
      const std::size_t more = report_.judgement.reasons.size() - kReasonsDrawn;
      AppendText(body_, {column_x_ + 12.0, y}, "and " + std::to_string(more) + " more",
                 {.size = 12.0, .colour = kFaint});
    }
    return y;
  }

  void Heading(double y, std::string_view text) {
    AppendText(body_, {column_x_, y}, text, {.size = 13.0, .colour = kFaint, .bold = true});
    AppendLine(body_, {column_x_, y + 7.0}, {column_x_ + kPictureColumn, y + 7.0},
               "stroke=\"#d3dae1\" stroke-width=\"1\"");
  }

  double DrawFigures(double y) {
    Heading(y, "Figures");
    y += 26.0;
    const auto row = [&](std::string_view name, const std::string& value) {
      AppendText(body_, {column_x_, y}, name, {.size = 13.0, .colour = kFaint});
      AppendText(body_, {column_x_ + kPictureColumn, y}, value, {.size = 13.0, .anchor = "end"});
      y += 20.0;
    };
    row("cut", Length(report_.total.cut_mm));
    row("travel", Length(report_.total.travel_mm));
    if (shape_.laser_watts > 0.0) {
      row("beam on", DurationText(report_.total.beam_on));
      row("pierces", std::to_string(report_.total.pierces));
      row("energy", FixedText(report_.total.energy_j() / 1000.0, 2) + " kJ");
    } else {
      row("plunges", std::to_string(report_.total.plunges));
    }
    const machine::Box& box = report_.cut.empty() ? report_.tip : report_.cut;
    if (!box.empty()) {
      const motion::MachineVector size = box.max - box.min;
      const auto side = [](double mm) { return TrimmedText(mm, mm < 100.0 ? 2 : 1); };
      row(report_.cut.empty() ? "extent" : "cut extent",
          side(size.x()) + " × " + side(size.y()) + " × " + side(size.z()) + " mm");
    }
    row("steps", std::to_string(report_.steps_executed));
    if (!report_.findings.empty()) {
      row("findings", std::to_string(report_.findings.size() + report_.findings_dropped.count()));
    }
    return y;
  }

  double DrawLegend(double y) {
    Heading(y, "Legend");
    y += 26.0;
    const double x = column_x_;
    const auto name = [&](std::string_view text) {
      AppendText(body_, {x + 58.0, y + 4.0}, text, {.size = 13.0});
      y += 21.0;
    };
    if (depth_.shaded) {
      for (int shade = 0; shade < kShades; ++shade) {
        AppendRect(body_, {x + 5.5 * shade, y - 4.0, 5.7, 8.0},
                   "fill=\"" + std::string(kShadeColours[shade]) + '"');
      }
      name("cut, Z " + FixedText(depth_.high_mm - zero_.z(), 2) + " to " +
           FixedText(depth_.low_mm - zero_.z(), 2));
    } else {
      AppendLine(body_, {x, y}, {x + 44.0, y},
                 "stroke=\"" + std::string(kCutColour) + "\" stroke-width=\"2.2\"");
      name(shape_.laser_watts > 0.0 ? "beam on" : "cut");
    }
    if (sketch_.skims_beside_cuts()) {
      AppendLine(body_, {x, y}, {x + 44.0, y}, std::string("class=\"skim\" ") + kSkimStyle);
      name("along the surface, not cut");
    }
    AppendLine(body_, {x, y}, {x + 44.0, y},
               "stroke=\"" + std::string(kTravelColour) +
                   "\" stroke-width=\"1\" stroke-dasharray=\"5 3.5\"");
    name("travel");
    if (sketch_.lost_mm() > 0.0) {
      AppendLine(body_, {x, y}, {x + 44.0, y}, std::string("class=\"lost\" ") + kLostStyle);
      name("beyond the travel, not cut");
      AppendText(body_, {x + 58.0, y + 2.0}, Length(sketch_.lost_mm()) + " lost",
                 {.size = 12.0, .colour = kLostColour});
      y += 19.0;
    }
    if (!sketch_.dots().empty()) {
      const bool pierce = sketch_.dots().front().pierce;
      AppendCircle(
          body_, {x + 22.0, y}, pierce ? 4.2 : 2.4,
          pierce ? "fill=\"#e8590c\"" : "fill=\"#ffffff\" stroke=\"#e8590c\" stroke-width=\"1.2\"");
      name(pierce ? "pierce" : "plunge");
    }
    const bool in_space = std::any_of(layout_.panels.begin(), layout_.panels.end(),
                                      [](const Panel& p) { return p.frame.across.empty(); });
    if (!sketch_.tools().empty() && in_space) {
      AppendLine(body_, {x + 8.0, y + 5.0}, {x + 36.0, y - 5.0},
                 "stroke=\"#0f8a5f\" stroke-width=\"1\"");
      name("direction of the head");
    }
    if (sketch_.moved()) {
      AppendCircle(body_, {x + 22.0, y}, 5.5,
                   "fill=\"none\" stroke=\"#2b8a3e\" stroke-width=\"2\"");
      name("start");
      DrawEndMark({x + 22.0, y});
      name(completed() ? "end" : "where it ended");
    }
    if (!shape_.travel.empty()) {
      AppendLine(body_, {x, y}, {x + 44.0, y},
                 "stroke=\"#b0894a\" stroke-width=\"1.3\" stroke-dasharray=\"14 4 2 4\"");
      name("travel of the machine");
    }
    if (sketch_.tolerance_mm() > 0.0) {
      AppendText(body_, {x, y + 4.0}, "drawn coarser: the program is very long",
                 {.size = 12.0, .colour = "#b4540a"});
      y += 21.0;
    }
    return y;
  }

  void DrawEndMark(ScreenPoint at) {
    if (completed()) {
      AppendRect(body_, {at.x - 3.5, at.y - 3.5, 7.0, 7.0}, "fill=\"#1c2733\"");
      return;
    }
    const std::string_view style = "stroke=\"#c92a2a\" stroke-width=\"2.4\"";
    AppendLine(body_, {at.x - 5, at.y - 5}, {at.x + 5, at.y + 5}, style);
    AppendLine(body_, {at.x - 5, at.y + 5}, {at.x + 5, at.y - 5}, style);
  }

  // A small map: the travel of the machine from above, and what the picture shows of it.
  double DrawPlace(double y) {
    const machine::Box& travel = shape_.travel;
    if (travel.empty() || sketch_.box().empty()) return y;
    Heading(y, "Place on the machine");
    y += 20.0;
    machine::Box all = travel;
    all.Add(sketch_.box());
    const double width = all.max.x() - all.min.x();
    const double height = all.max.y() - all.min.y();
    if (!(width > 0.0) || !(height > 0.0)) return y;
    const double scale = std::min(kPictureColumn / width, 190.0 / height);
    const auto place = [&](const machine::Box& box) {
      return ScreenRect{column_x_ + (box.min.x() - all.min.x()) * scale,
                        y + (all.max.y() - box.max.y()) * scale,
                        (box.max.x() - box.min.x()) * scale, (box.max.y() - box.min.y()) * scale};
    };
    AppendRect(body_, place(travel),
               "fill=\"#ffffff\" stroke=\"#b0894a\" stroke-width=\"1.2\" "
               "stroke-dasharray=\"14 4 2 4\"");
    AppendRect(body_, place(sketch_.box()),
               "fill=\"none\" stroke=\"#7d8b99\" stroke-width=\"0.9\" stroke-dasharray=\"5 3.5\"");
    const machine::Box& part = sketch_.cut_box().empty() ? sketch_.box() : sketch_.cut_box();
    ScreenRect shown = place(part);
    constexpr double kSmallest = 4.0;  // a part of a pixel can still be found
    if (shown.width < kSmallest) {
      shown.x -= 0.5 * (kSmallest - shown.width);
      shown.width = kSmallest;
    }
    if (shown.height < kSmallest) {
      shown.y -= 0.5 * (kSmallest - shown.height);
      shown.height = kSmallest;
    }
    AppendRect(body_, shown,
               "fill=\"#0b4fa8\" fill-opacity=\"0.25\" stroke=\"#0b4fa8\" stroke-width=\"1.4\"");
    y += height * scale + 18.0;
    const auto range = [](double low, double high) {
      const auto tenths = [](double mm) { return ShortestText(std::round(10.0 * mm) / 10.0); };
      return tenths(low) + " to " + tenths(high);
    };
    AppendText(body_, {column_x_, y},
               "X " + range(travel.min.x(), travel.max.x()) + ", Y " +
                   range(travel.min.y(), travel.max.y()) + ", Z " +
                   range(travel.min.z(), travel.max.z()) + " mm",
               {.size = 11.0, .colour = kFaint});
    return y + 12.0;
  }

  void DrawFooter(double height) {
    std::string text(zero_text_);
    if (!report_.inputs_hash.empty()) text += "   ·   inputs " + report_.inputs_hash.substr(0, 12);
    if (!report_.engine_version.empty()) text += "   ·   engine " + report_.engine_version;
    AppendText(body_, {kPageMargin, height - 14.0}, text, {.size = 11.0, .colour = "#93a0ab"});
  }

  const PathSketch& sketch_;
  machine::MachineShape shape_;  // with the work origin of the end
  const RunReport& report_;
  int width_ = 0;
  int shown_px_ = 0;  // a page that is shown narrower than it is laid out is made smaller
  DepthRange depth_;
  motion::MachinePoint zero_;
  std::string_view zero_text_;
  PanelLayout layout_;
  double column_x_ = 0.0;
  std::string body_;
};

}  // namespace

std::string DurationText(SimTime time) {
  const double seconds = ToSeconds(time);
  // Rounded first: nothing takes "60.000 s".
  if (std::llround(seconds * 1000.0) < 60'000) return FixedText(seconds, 3) + " s";
  const auto two_digits = [](std::string text, std::size_t length) {
    if (text.size() < length) text.insert(0, 1, '0');
    return text;
  };
  const std::int64_t tenths = std::llround(seconds * 10.0);
  if (tenths < 36'000) {
    const std::string rest = FixedText(static_cast<double>(tenths % 600) / 10.0, 1);
    return std::to_string(tenths / 600) + " min " + two_digits(rest, 4) + " s";
  }
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  return std::to_string(whole / 3600) + " h " + two_digits(std::to_string(whole / 60 % 60), 2) +
         " min " + two_digits(std::to_string(whole % 60), 2) + " s";
}

std::string PicturePage(const PathSketch& sketch, const machine::MachineShape& shape,
                        const RunReport& report, const PictureOptions& options) {
  return PageWriter(sketch, shape, report, options).Svg();
}

}  // namespace rmlcell::simulation
