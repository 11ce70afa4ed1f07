/// @file
/// Room `core`: words and numbers from outside, as a line of a message can bear them, and numbers out of words.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tissue_contact {

/// Of ASCII, whatever the locale of the process.
inline bool isControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

/// The first `most` bytes of `text` (fewer where that would cut a character of UTF-8), "..." where there are more; '?' for
/// every control character.
std::string printable(const std::string& text, std::size_t most = 60);

/// The same in double quotes, at most 80 bytes of it.
std::string inQuotes(const std::string& text);

/// "a, b, c".
std::string joined(const std::vector<std::string>& words);

/// "a, b, ...": the first `most` of them, printable.
std::string listOf(const std::vector<std::string>& names, std::size_t most = 12);

/// A figure for people: rounded to two digits, without an exponent from 1e-5 to 1e6.
std::string twoDigits(double value);

/// A stamp in ns as "seconds.nanoseconds", exact.
std::string stampText(std::int64_t stamp_ns);

/// The number that all of `text` spells, whatever the locale of the process; nothing for any other text, and for a number
/// that the type cannot hold. A leading plus is allowed; of doubles also "inf" and "nan".
std::optional<double> toDouble(std::string_view text);
std::optional<std::int64_t> toInteger(std::string_view text);

}  // namespace tissue_contact
