/// @file
/// Room `core`: see printable.h.
#include "tissue_contact/core/printable.h"

#include <algorithm>

namespace tissue_contact {

std::string printable(const std::string& name, std::size_t most) {
  std::string text = name.substr(0, most);
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  std::replace_if(text.begin(), text.end(), is_control, '?');
  return name.size() > most ? text + "..." : text;
}

std::string listOf(const std::vector<std::string>& names, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) text += (i == 0 ? "" : ", ") + printable(names[i]);
  return names.size() > most ? text + ", ..." : text;
}

}  // namespace tissue_contact
