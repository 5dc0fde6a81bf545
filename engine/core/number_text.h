#pragma once

#include <optional>
#include <string>
#include <string_view>

// Numbers to text and back, the same on every platform and in every locale.
namespace rmlcell {

// Fixed decimals, at most 100; "-0.000" is written as "0.000".
std::string FixedText(double value, int decimals);

// Up to `decimals` decimals, trailing zeros removed, at least one decimal kept: "12.7", "0.0".
std::string TrimmedText(double value, int decimals);

// The same behind what stands in `text`, for who writes millions of them.
void AppendFixed(std::string& text, double value, int decimals);
void AppendTrimmed(std::string& text, double value, int decimals);

// The shortest text that reads back to the same value: "0.1", "12", "1e-07".
std::string ShortestText(double value);

// The whole text must be one finite number; blanks are not skipped.
std::optional<double> ParseDouble(std::string_view text);
std::optional<long long> ParseInteger(std::string_view text);

}  // namespace rmlcell
