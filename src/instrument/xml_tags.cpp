#include "instrument/xml_tags.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace tissue_contact {
namespace {

/// Offset just behind `end`, searched from `from`; the end of the text if it is missing.
std::size_t behind(std::string_view xml, std::string_view end, std::size_t from) {
  const std::size_t found = xml.find(end, from);
  return found == std::string_view::npos ? xml.size() : found + end.size();
}

/// Offset of the '>' that ends the tag starting at `from`; a '>' inside a quoted attribute value does not.
std::size_t endOfTag(std::string_view xml, std::size_t from) {
  char quote = 0;
  for (std::size_t i = from; i < xml.size(); ++i) {
    if (quote != 0) {
      if (xml[i] == quote) quote = 0;
    } else if (xml[i] == '"' || xml[i] == '\'') {
      quote = xml[i];
    } else if (xml[i] == '>') {
      return i;
    }
  }
  return xml.size();
}

[[noreturn]] void refuse(std::string_view xml, const std::string& source, std::size_t position,
                         const std::string& what) {
  throw std::invalid_argument(source + ":" + std::to_string(lineOf(xml, position)) + ": malformed XML: " + what);
}

}  // namespace

bool XmlTagScanner::next(XmlTag& tag) {
  while ((at_ = xml_.find('<', at_)) != std::string_view::npos) {
    const std::string_view rest = xml_.substr(at_);
    if (rest.substr(0, 4) == "<!--") {
      at_ = behind(xml_, "-->", at_ + 4);
    } else if (rest.substr(0, 9) == "<![CDATA[") {
      at_ = behind(xml_, "]]>", at_ + 9);
    } else if (rest.substr(0, 2) == "<!" || rest.substr(0, 2) == "<?") {
      at_ = behind(xml_, ">", at_ + 2);
    } else {
      break;
    }
  }
  if (at_ == std::string_view::npos) {
    at_ = xml_.size();
    return false;
  }
  const std::size_t end = endOfTag(xml_, at_ + 1);
  std::string_view inside = xml_.substr(at_ + 1, end - at_ - 1);
  tag.position = at_;
  tag.kind = XmlTag::Kind::kOpen;
  if (!inside.empty() && inside.front() == '/') {
    tag.kind = XmlTag::Kind::kClose;
    inside.remove_prefix(1);
  } else if (!inside.empty() && inside.back() == '/') {
    tag.kind = XmlTag::Kind::kEmpty;
    inside.remove_suffix(1);
  }
  tag.name = inside.substr(0, inside.find_first_of(" \t\r\n"));
  at_ = std::min(end + 1, xml_.size());
  return true;
}

int lineOf(std::string_view text, std::size_t position) {
  const std::string_view before = text.substr(0, position);
  return 1 + static_cast<int>(std::count(before.begin(), before.end(), '\n'));
}

void checkXmlNesting(std::string_view xml, const std::string& source, std::size_t max_depth) {
  std::vector<XmlTag> open;
  XmlTagScanner scanner(xml);
  for (XmlTag tag; scanner.next(tag);) {
    const std::string name(tag.name.substr(0, 80));
    if (tag.kind == XmlTag::Kind::kOpen) {
      open.push_back(tag);
      if (open.size() > max_depth) {
        refuse(xml, source, tag.position,
               "<" + name + "> is nested more than " + std::to_string(max_depth) + " levels deep");
      }
    } else if (tag.kind == XmlTag::Kind::kClose) {
      if (open.empty()) refuse(xml, source, tag.position, "</" + name + "> closes nothing");
      if (open.back().name != tag.name) {
        refuse(xml, source, tag.position,
               "</" + name + "> does not close <" + std::string(open.back().name.substr(0, 80)) + "> of line " +
                   std::to_string(lineOf(xml, open.back().position)));
      }
      open.pop_back();
    }
  }
  if (!open.empty()) {
    refuse(xml, source, open.back().position, "<" + std::string(open.back().name.substr(0, 80)) + "> is never closed");
  }
}

}  // namespace tissue_contact
