/// @file
/// Room `validation`: the list of everything the product is checked against. Each case builds its scenes, runs them with
/// the product's own pipeline and reports; one file per case (or few) beside this one.
#pragma once

#include <vector>

#include "validation/report.h"

namespace tissue_contact {

struct ValidationCase {
  const char* name;   ///< for --case; lower case with dashes
  const char* title;  ///< one line
  void (*run)(Report&);
};

/// In the order in which they are run and printed: closed forms first, then hard cases.
const std::vector<ValidationCase>& validationCases();

}  // namespace tissue_contact
