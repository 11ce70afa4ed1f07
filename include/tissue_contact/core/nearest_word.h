/// @file
/// Room `core`: the word somebody may have meant.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tissue_contact {

/// The one of `allowed` that takes the fewest insertions, deletions and replacements (Levenshtein 1966) to become `word`;
/// the first of several; one that only lacks its "_suffix" counts as one. Empty when all need more than half of the
/// word (and more than two), or the word is empty or longer than 80 bytes.
std::string nearestWord(const std::string& word, const std::vector<std::string>& allowed);

/// The same; empty when all need more than `most`.
std::string nearestWord(const std::string& word, const std::vector<std::string>& allowed, std::size_t most);

/// `did you mean "<the nearest>"? `, or "" when none is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& allowed);

}  // namespace tissue_contact
