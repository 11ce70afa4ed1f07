/// @file
/// Room `instrument` (private): a minimal tokenizer over the tags of an XML text. It does not replace the parsers of
/// urdfdom and assimp: it runs before them, because both recurse once per nesting level and end the process by a stack
/// overflow on a file that nests deep enough, and because urdfdom reports syntax errors without a line.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tissue_contact {

/// One tag as it stands in the text; views into that text.
struct XmlTag {
  enum class Kind { kOpen, kClose, kEmpty } kind = Kind::kOpen;  ///< <a>, </a>, <a/>
  std::string_view name;
  std::size_t position = 0;  ///< offset of '<' in the text
};

/// Walks over the tags; skips text, comments, CDATA, declarations and processing instructions.
class XmlTagScanner {
 public:
  /// @param xml must outlive the scanner and the tags it returns.
  explicit XmlTagScanner(std::string_view xml) : xml_(xml) {}

  /// The next tag; false at the end of the text. A tag that is never finished is returned up to the end of the text.
  bool next(XmlTag& tag);

 private:
  std::string_view xml_;
  std::size_t at_ = 0;
};

/// Line (1 = first) of an offset in a text.
int lineOf(std::string_view text, std::size_t position);

/// Refuses a text whose tags are not properly nested or nest deeper than `max_depth`.
/// @throws std::invalid_argument "<source>:<line>: <what>".
void checkXmlNesting(std::string_view xml, const std::string& source, std::size_t max_depth);

}  // namespace tissue_contact
