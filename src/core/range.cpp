#include "tissue_contact/core/range.h"

#include <locale>
#include <sstream>

#include "tissue_contact/core/check.h"

namespace tissue_contact {

std::string Range::text() const {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << (low_excluded ? "> " : ">= ") << low << " and " << (high_excluded ? "< " : "<= ") << high;
  return text.str() + (*unit == '\0' ? "" : " ") + unit;
}

double Range::require(const std::string& what, double value) const {
  if (!contains(value)) throwBadValue(what, value, unit, text() + (*fix == '\0' ? "" : "; ") + fix);
  return value;
}

}  // namespace tissue_contact
