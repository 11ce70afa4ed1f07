#include "validation/cases.h"

#include "validation/closed_forms.h"
#include "validation/hard_cases.h"

namespace tissue_contact {

const std::vector<ValidationCase>& validationCases() {
  static const std::vector<ValidationCase> cases = {
      {"incline", "B: a block on an incline holds, creeps not, slides at g (sin - mu cos)", validateIncline},
  };
  return cases;
}

}  // namespace tissue_contact
