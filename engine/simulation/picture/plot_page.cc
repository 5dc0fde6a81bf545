#include "engine/simulation/picture/plot_page.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/number_text.h"
#include "engine/simulation/picture/picture_page.h"
#include "engine/simulation/picture/picture_view.h"
#include "engine/simulation/picture/svg_shapes.h"
#include "engine/simulation/picture/text_width.h"

namespace rmlcell::simulation {
namespace {

constexpr double kPlotHeader = 84.0;
constexpr std::size_t kReasonPlotted = 80;  // characters
constexpr double kPlotLeft = 92.0;          // titles and ticks of the panels
constexpr double kMarkRow = 22.0;           // names of the marks
constexpr double kPlotGap = 22.0;           // between panels
constexpr double kTimeAxis = 46.0;
constexpr double kPlotFooter = 22.0;
constexpr int kPlotWidthMin = 640;
constexpr double kTickPixels_x = 90.0;  // at least, between two ticks
constexpr double kTickPixels_y = 26.0;
constexpr double kMoved = 1e-9;  // mm, rad: an axis that moves less stands

constexpr std::array<std::string_view, motion::kAxisCount> kAxisTitles = {"X", "Y", "Z", "A", "B"};
constexpr std::array<std::string_view, motion::kAxisCount> kAxisColours = {
    "#c92a2a", "#2b8a3e", "#0b4fa8", "#b0640a", "#7b3fb5"};
constexpr std::string_view kFeedColour = "#9aa7b3";

// The least and greatest of a series.
std::pair<double, double> Limits(const TimeEnvelope& envelope, std::size_t series) {
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
  for (const TimeEnvelope::Bucket& bucket : envelope.buckets()) {
    low = std::min(low, bucket.ranges[series].low);
    high = std::max(high, bucket.ranges[series].high);
  }
  return {low, high};
}

// A curve as path data; points that go on at the same height are one line.
class CurveWriter {
 public:
  void Add(ScreenPoint to) {
    to.y = std::round(to.y * 100.0) / 100.0;
    if (!pending_) {
      data_.MoveTo(to);
      drawn_ = to;
    } else if (pending_->y != to.y || drawn_.y != to.y) {
      data_.LineTo(*pending_);
      drawn_ = *pending_;
    }
    pending_ = to;
  }
  std::string Finish() {
    if (pending_) data_.LineTo(*pending_);
    return data_.text();
  }

 private:
  PathData data_;
  ScreenPoint drawn_;  // how far the data go
  std::optional<ScreenPoint> pending_;
};

}  // namespace

PlotPage::PlotPage(const Curves& curves, const machine::MachineShape& shape,
                   const RunReport& report, const PlotOptions& options)
    : curves_(curves), shape_(shape), report_(report), panels_(PanelsOf(options)) {
  page_width_ = std::clamp(options.width_px, kPlotWidthMin, kPageWidthMax);
  left_ = kPageMargin + kPlotLeft;
  width_ = page_width_ - kPageMargin - left_;
  duration_s_ = std::max(ToSeconds(report.cycle_time), 1e-9);
}

std::vector<PlotPage::Panel> PlotPage::PanelsOf(const PlotOptions& options) const {
  std::vector<Panel> panels;
  for (const PlotCurve curve : options.curves) {
    if (curve == PlotCurve::kSpeed) {
      // A run of positioning moves asks for no speed of the tip.
      const bool asks = Limits(curves_.envelope, PlotSeries::kFeed).second > 0.0;
      panels.push_back(
          {.title = "tip speed",
           .unit = "mm/s",
           .series = asks ? std::vector<std::size_t>{PlotSeries::kSpeed, PlotSeries::kFeed}
                          : std::vector<std::size_t>{PlotSeries::kSpeed},
           .colour = "#0b4fa8",
           .height = 220.0,
           .from_zero = true});
    } else if (curve == PlotCurve::kPower) {
      if (shape_.laser_watts <= 0.0) continue;  // a mill has no beam
      panels.push_back({.title = "power",
                        .unit = "%",
                        .series = {PlotSeries::kPower},
                        .colour = "#e8590c",
                        .height = 130.0,
                        .from_zero = true,
                        .hundred = true});
    } else {
      for (std::size_t axis = 0; axis < kAxisTitles.size(); ++axis) {
        const auto [low, high] = Limits(curves_.envelope, PlotSeries::kFirstAxis + axis);
        if (!(high - low > kMoved)) continue;
        panels.push_back({.title = std::string(kAxisTitles[axis]),
                          .unit = axis < 3 ? "mm" : "rad",
                          .series = {PlotSeries::kFirstAxis + axis},
                          .colour = kAxisColours[axis],
                          .height = 96.0});
      }
    }
  }
  return panels;
}

PlotPage::Scale PlotPage::ScaleOf(const Panel& panel, double top) const {
  Scale scale{.low = HUGE_VAL, .high = -HUGE_VAL, .top = top, .height = panel.height};
  for (const std::size_t series : panel.series) {
    const auto [low, high] = Limits(curves_.envelope, series);
    scale.low = std::min(scale.low, low);
    scale.high = std::max(scale.high, high);
  }
  if (panel.from_zero) scale.low = std::min(scale.low, 0.0);
  if (panel.hundred) scale.high = std::max(scale.high, 100.0);
  if (!(scale.high > scale.low)) {  // nothing to see, or one value
    if (!std::isfinite(scale.low)) scale.low = 0.0;
    scale.high = scale.low + 1.0;
  }
  const double room = 0.04 * (scale.high - scale.low);
  scale.high += room;
  if (!panel.from_zero) scale.low -= room;
  return scale;
}

std::string PlotPage::Svg() {
  DrawHeader();
  const bool marked = !curves_.marks.empty();
  const double top = kPlotHeader + kPlotGap + (marked ? kMarkRow : 0.0);
  double bottom = top;
  for (const Panel& panel : panels_) bottom += panel.height + kPlotGap;
  if (panels_.empty()) bottom += 60.0 + kPlotGap;
  bottom -= kPlotGap;
  DrawTimeGrid(top, bottom);
  if (panels_.empty()) {
    AppendText(body_, {left_ + 0.5 * width_, top + 34.0}, "nothing moved",
               {.size = 14.0, .colour = kFaint, .anchor = "middle"});
  }
  double y = top;
  for (const Panel& panel : panels_) {
    DrawPanel(panel, y);
    y += panel.height + kPlotGap;
  }
  if (marked) DrawMarks(top, bottom);
  const double height = std::ceil(bottom + kTimeAxis + kPlotFooter);
  std::string footer = "virtual time, s";
  if (!report_.inputs_hash.empty()) footer += "   ·   inputs " + report_.inputs_hash.substr(0, 12);
  if (!report_.engine_version.empty()) footer += "   ·   engine " + report_.engine_version;
  AppendText(body_, {kPageMargin, height - 12.0}, footer, {.size = 11.0, .colour = "#93a0ab"});

  const std::string size = Pixels(page_width_) + "\" height=\"" + Pixels(height);
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  out += "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + size + "\" viewBox=\"0 0 " +
         Pixels(page_width_) + ' ' + Pixels(height) +
         "\" font-family=\"Inter, 'Helvetica Neue', Arial, 'Liberation Sans', sans-serif\">\n";
  out += "<title>" + XmlText(report_.title.empty() ? "Plot" : report_.title) + "</title>\n";
  AppendRect(out, {0, 0, page_width_, height}, "fill=\"#f7f9fa\"");
  return out + body_ + "</svg>\n";
}

void PlotPage::DrawHeader() {
  AppendRect(body_, {0, 0, page_width_, kPlotHeader}, "fill=\"#ffffff\"");
  AppendLine(body_, {0, kPlotHeader}, {page_width_, kPlotHeader},
             "stroke=\"#d3dae1\" stroke-width=\"1\"");
  const double right = page_width_ - kPageMargin;
  const std::string duration = DurationText(report_.cycle_time);
  const TextStyle large{.size = 24.0, .bold = true};
  const std::string title = report_.title.empty() ? "Plot" : report_.title;
  AppendText(body_, {kPageMargin, 40.0},
             Fitted(title, right - kPageMargin - kTextGap - TextWidth(duration, large), large),
             large);
  std::string outcome(OutcomeText(report_.outcome.kind));
  std::replace(outcome.begin(), outcome.end(), '_', ' ');
  if (report_.outcome.code) outcome += "  " + CodeText(*report_.outcome.code);
  const machine::Judgement& judged = report_.judgement;
  outcome = std::string(machine::VerdictText(judged.verdict)) + ", " + outcome;
  if (!judged.reasons.empty())
    outcome += ": " + Shortened(judged.reasons.front().said, kReasonPlotted);
  const TextStyle small{.size = 14.0,
                        .colour = judged.verdict == machine::Verdict::kGood ? kFaint : "#b42318"};
  constexpr std::string_view kCycleTime = "cycle time";
  AppendText(body_, {kPageMargin, 64.0},
             Fitted(outcome, right - kPageMargin - kTextGap - TextWidth(kCycleTime, small), small),
             small);
  AppendText(body_, {right, 40.0}, duration, {.size = 24.0, .anchor = "end", .bold = true});
  AppendText(body_, {right, 64.0}, kCycleTime, {.size = 14.0, .colour = kFaint, .anchor = "end"});
}

void PlotPage::DrawTimeGrid(double top, double bottom) {
  AppendRect(body_, {left_, top, width_, bottom - top}, "fill=\"#ffffff\"");
  const double step = NiceStep(duration_s_ * kTickPixels_x / width_);
  const auto ticks = static_cast<int>(std::floor(duration_s_ / step + 1e-9));
  for (int k = 0; k <= ticks; ++k) {
    const double x = X(k * step);
    AppendLine(body_, {x, top}, {x, bottom}, "stroke=\"#edf1f4\" stroke-width=\"1\"");
    AppendLine(body_, {x, bottom}, {x, bottom + 5.0}, "stroke=\"#7d8b99\" stroke-width=\"1\"");
    AppendText(body_, {x, bottom + 20.0}, TickText(k * step, step),
               {.size = 12.0, .colour = kFaint, .anchor = "middle"});
  }
  AppendText(body_, {left_ + width_, bottom + 38.0}, "time, s",
             {.size = 12.0, .colour = kFaint, .anchor = "end"});
}

void PlotPage::DrawPanel(const Panel& panel, double top) {
  const Scale scale = ScaleOf(panel, top);
  const double step = NiceStep((scale.high - scale.low) * kTickPixels_y / panel.height);
  const auto first = static_cast<long long>(std::ceil(scale.low / step - 1e-9));
  const auto last = static_cast<long long>(std::floor(scale.high / step + 1e-9));
  for (long long k = first; k <= last; ++k) {
    const double value = static_cast<double>(k) * step;
    const double y = scale.At(value);
    AppendLine(body_, {left_, y}, {left_ + width_, y}, "stroke=\"#edf1f4\" stroke-width=\"1\"");
    AppendText(body_, {left_ - 8.0, y + 4.0}, TickText(value, step),
               {.size = 11.0, .colour = kFaint, .anchor = "end"});
  }
  AppendRect(body_, {left_, top, width_, panel.height},
             "fill=\"none\" stroke=\"#d3dae1\" stroke-width=\"1\"");
  AppendText(body_, {kPageMargin, top + 14.0}, panel.title,
             {.size = 14.0, .colour = panel.colour, .bold = true});
  AppendText(body_, {kPageMargin, top + 31.0}, panel.unit, {.size = 12.0, .colour = kFaint});
  for (std::size_t k = panel.series.size(); k-- > 0;) {
    const std::string data = CurveData(panel.series[k], scale);
    if (data.empty()) continue;
    body_ += "<path d=\"" + data + "\" fill=\"none\" stroke=\"";
    body_ += k == 0 ? panel.colour : kFeedColour;
    body_ += k == 0 ? "\" stroke-width=\"1.5\"" : "\" stroke-width=\"1\" stroke-dasharray=\"4 3\"";
    body_ += " stroke-linejoin=\"round\"/>\n";
  }
  if (panel.series.size() > 1) {
    AppendLine(body_, {kPageMargin, top + 46.0}, {kPageMargin + 24.0, top + 46.0},
               "stroke=\"#9aa7b3\" stroke-width=\"1\" stroke-dasharray=\"4 3\"");
    AppendText(body_, {kPageMargin, top + 61.0}, "asked for", {.size = 11.0, .colour = kFaint});
  }
}

std::string PlotPage::CurveData(std::size_t series, const Scale& scale) const {
  CurveWriter curve;
  const double width_s = ToSeconds(curves_.envelope.width());
  for (const TimeEnvelope::Bucket& bucket : curves_.envelope.buckets()) {
    const TimeEnvelope::Range& range = bucket.ranges[series];
    const double begin = static_cast<double>(bucket.number) * width_s;
    const double end = std::min(begin + width_s, duration_s_);
    const double middle = 0.5 * (begin + end);
    curve.Add({X(std::min(begin, duration_s_)), scale.At(range.first)});
    const bool inner_low = range.low < std::min(range.first, range.last);
    const bool inner_high = range.high > std::max(range.first, range.last);
    if (inner_low && range.low_first) curve.Add({X(middle), scale.At(range.low)});
    if (inner_high) curve.Add({X(middle), scale.At(range.high)});
    if (inner_low && !range.low_first) curve.Add({X(middle), scale.At(range.low)});
    const bool ends = &bucket == &curves_.envelope.buckets().back();
    if (range.last != range.first || inner_low || inner_high || ends) {
      curve.Add({X(end), scale.At(range.last)});
    }
  }
  return curve.Finish();
}

void PlotPage::DrawMarks(double top, double bottom) {
  double free_from = left_;  // names must not cover each other
  for (const Mark& mark : curves_.marks) {
    const double x = X(std::clamp(ToSeconds(mark.at), 0.0, duration_s_));
    const std::string_view colour = mark.error ? "#c92a2a" : "#b4540a";
    AppendLine(
        body_, {x, top - 4.0}, {x, bottom},
        "stroke=\"" + std::string(colour) + "\" stroke-width=\"1\" stroke-dasharray=\"2 3\"");
    const double wide = 7.0 * static_cast<double>(mark.text.size());
    if (x < free_from) continue;
    AppendText(body_, {std::min(x, left_ + width_ - wide), top - 9.0}, mark.text,
               {.size = 11.0, .colour = colour});
    free_from = x + wide + 8.0;
  }
}

}  // namespace rmlcell::simulation
