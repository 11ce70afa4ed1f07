#include "tissue_contact/core/nearest_word.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kLongestWordBytes = 80;  ///< the cost is the product of both lengths, and text may be hostile

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string nearestWord(const std::string& word, const std::vector<std::string>& allowed) {
  return nearestWord(word, allowed, std::max<std::size_t>(2, word.size() / 2));
}

std::string nearestWord(const std::string& word, const std::vector<std::string>& allowed, std::size_t most) {
  if (word.empty() || word.size() > kLongestWordBytes) return "";
  std::string nearest;
  std::size_t least = most;
  for (const std::string& candidate : allowed) {
    const bool lacks_suffix = candidate.size() > word.size() && candidate.compare(0, word.size() + 1, word + "_") == 0;
    const std::size_t distance = lacks_suffix ? 1 : editDistance(word, candidate);
    if (distance > least || (distance == least && !nearest.empty())) continue;
    nearest = candidate;
    least = distance;
  }
  return nearest;
}

std::string suggestion(const std::string& word, const std::vector<std::string>& allowed) {
  const std::string nearest = nearestWord(word, allowed);
  return nearest.empty() ? "" : "did you mean " + inQuotes(nearest) + "? ";
}

}  // namespace tissue_contact
