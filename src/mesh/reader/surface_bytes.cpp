#include "mesh/reader/surface_bytes.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

#include "mesh/reader/assimp_reader.h"
#include "tissue_contact/core/read_file.h"

namespace tissue_contact {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::size_t kStlHeader = 84;  // bytes, with the number of triangles
constexpr std::size_t kStlTriangle = 50;
constexpr std::size_t kLongestLine = 1000;  // of a name; assimp takes 1023 bytes of it

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

bool startsWith(std::string_view text, std::string_view start) { return text.substr(0, start.size()) == start; }

std::size_t skippedBlanks(std::string_view text) { return std::min(text.find_first_not_of(kBlanks), text.size()); }

/// `change(line, result)` appends what a line, without its end, is to become.
template <typename Change>
std::string withLines(std::string_view text, const Change& change) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    change(text.substr(at, end - at), result);
    if (end < text.size()) result += text[end];
    at = end + 1;
  }
  return result;
}

/// Where a line's first `count` words end; its end where it has fewer.
std::size_t behindWords(std::string_view line, int count) {
  std::size_t at = 0;
  for (int word = 0; word < count; ++word) {
    at += skippedBlanks(line.substr(at));
    at = std::min(line.find_first_of(kBlanks, at), line.size());
  }
  return at;
}

/// An STL of text that assimp does not read as others do; empty for all others. Whether it is a text at all is told by `facet`
/// near its start, or behind a name that is longer than that.
std::string withoutOddities(std::string_view stl, bool& is_text) {
  const std::size_t marked = startsWith(stl, kByteOrderMark) ? kByteOrderMark.size() : 0;
  const std::size_t blanks = marked + skippedBlanks(stl.substr(marked));
  std::string_view text = stl.substr(blanks);
  const std::size_t name_end = std::min(text.find_first_of("\r\n"), text.size());
  const bool is_long = name_end > kLongestLine;
  if (is_long) text.remove_prefix(name_end);
  const std::string_view start = text.substr(0, 1024);
  const std::size_t facet = lowerCase(start).find("facet");
  is_text = lowerCase(stl.substr(blanks, 5)) == "solid" && facet != std::string_view::npos;
  if (!is_text) return {};
  const bool is_capital = stl.substr(blanks, 5) != "solid" || start.substr(facet, 5) != "facet";
  const bool is_odd = text.find_first_of("#(", is_long ? 0 : name_end) != std::string_view::npos;
  if (blanks == 0 && !is_long && !is_capital && !is_odd) return {};
  std::string other = (is_long ? "solid" : "") + (is_capital ? lowerCase(text) : std::string(text));
  if (!is_odd) return other;
  return withLines(other, [](std::string_view line, std::string& result) {
    const std::size_t behind = behindWords(line, 5);  // facet normal x y z
    const bool is_normal = startsWith(line.substr(skippedBlanks(line)), "facet") &&
                           line.substr(0, behind).find_first_of("#(") != std::string_view::npos;
    if (is_normal) result += "facet normal 0 0 0";
    result += is_normal ? line.substr(behind) : line;
  });
}

std::string otherStl(std::string stl) {
  std::size_t size = 0;  // of a binary one
  if (stl.size() >= kStlHeader) {
    std::uint32_t count = 0;
    std::memcpy(&count, &stl[kStlHeader - sizeof count], sizeof count);
    size = count > 0 ? kStlHeader + kStlTriangle * std::size_t{count} : 0;
  }
  if (stl.size() == size) return {};
  bool is_text = false;
  std::string other = withoutOddities(stl, is_text);
  if (is_text) return other;
  if (size == 0 || stl.size() < size || stl.size() - size >= kStlTriangle) return {};
  stl.resize(size);  // some write a few bytes behind the triangles; more may be another part
  return stl;
}

/// Behind `count` words of a line that has exactly `all` of them; its end where it has not.
std::size_t endOfWords(std::string_view line, int count, int all) {
  std::size_t end = line.size();
  int words = 0;
  for (std::size_t at = skippedBlanks(line); at < line.size(); ++words) {
    const std::size_t word_end = std::min(line.find_first_of(kBlanks, at), line.size());
    if (words + 1 == count) end = word_end;
    at = word_end + skippedBlanks(line.substr(word_end));
  }
  return words == all ? end : line.size();
}

/// What of a line of an OBJ is to be read.
std::string_view readPart(std::string_view line) {
  const std::size_t first = skippedBlanks(line);
  if (first == line.size() || (line[first] != 'v' && line[first] != 'f')) return line;
  if (line.back() == '\\') return line;  // which goes on in the next one
  const std::string_view read = line.substr(0, line.find('#'));
  const bool is_vertex = line[first] == 'v' && kBlanks.find(line.substr(first + 1, 1)) != std::string_view::npos;
  return is_vertex ? read.substr(0, endOfWords(read, 4, 8)) : read;
}

std::string otherObj(const std::string& obj) {
  const std::string_view text =
      std::string_view(obj).substr(startsWith(obj, kByteOrderMark) ? kByteOrderMark.size() : 0);
  std::string other = withLines(text, [](std::string_view line, std::string& result) { result += readPart(line); });
  return other == obj ? "" : other;
}

}  // namespace

std::string otherBytes(const std::string& file, const std::string& ending) {
  if (ending != "stl" && ending != "obj") return {};
  std::string bytes = readFile(file, "mesh file", kMaxSurfaceBytes);
  return ending == "stl" ? otherStl(std::move(bytes)) : otherObj(bytes);
}

}  // namespace tissue_contact
