#include "tissue_contact/core/text.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cinttypes>
#include <clocale>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <system_error>

namespace tissue_contact {

std::string printable(const std::string& text, std::size_t most) {
  std::size_t end = std::min(text.size(), most);
  while (end < text.size() && end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  std::string shown = text.substr(0, end);
  std::replace_if(shown.begin(), shown.end(), isControl, '?');
  return end < text.size() ? shown + "..." : shown;
}

std::string inQuotes(const std::string& text) {
  constexpr std::size_t kMostBytes = 80;
  return '"' + printable(text, kMostBytes) + '"';
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string listOf(const std::vector<std::string>& names, std::size_t most) {
  std::vector<std::string> shown;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) shown.push_back(printable(names[i]));
  if (names.size() > most) shown.emplace_back("...");
  return joined(shown);
}

std::string twoDigits(double value) {
  if (value != 0.0 && std::isfinite(value)) {
    // Of whole powers, so that 230 is 23 times 10 and not 22.999... times it.
    const int digits = static_cast<int>(std::floor(std::log10(std::abs(value)))) - 1;
    const double unit = std::pow(10.0, std::abs(digits));
    value = digits > 0 ? std::round(value / unit) * unit : std::round(value * unit) / unit;
  }
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string stampText(std::int64_t stamp_ns) {
  constexpr std::int64_t kNanosecondsPerSecond = 1000000000;
  char text[40];
  std::snprintf(text, sizeof text, "%" PRId64 ".%09" PRId64, stamp_ns / kNanosecondsPerSecond,
                std::abs(stamp_ns % kNanosecondsPerSecond));
  return text;
}

/// Not std::from_chars: the standard library of GCC 10 has it for integers only.
std::optional<double> toDouble(std::string_view text) {
  static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
  const bool starts = !text.empty() && text[0] > ' ';
  // Hexadecimal numbers are for strtod alone, and it would stop at a NUL.
  if (!starts || text.find_first_of(std::string_view("xX\0", 3)) != std::string_view::npos) return std::nullopt;
  const std::string copy(text);
  char* end = nullptr;
  errno = 0;
  const double value = strtod_l(copy.c_str(), &end, plain);
  if (end != copy.c_str() + copy.size()) return std::nullopt;
  if (errno == ERANGE && (value == 0.0 || std::isinf(value))) return std::nullopt;
  return value;
}

std::optional<std::int64_t> toInteger(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace tissue_contact
