/// @file
/// Room `validation`: results of validation cases as text, Markdown and JSON.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "validation/report.h"

namespace tissue_contact {

struct CaseResult {
  std::string name;
  std::string title;
  Report report;
  std::string failure;  ///< what an exception said; empty when the case ran to its end

  bool passed() const { return failure.empty() && report.passed(); }
};

/// Checks, convergence studies and notes of one case, in columns.
void printCase(const CaseResult& result, std::ostream& out);

/// All results as one JSON object {"passed": bool, "cases": [...]}. Numbers that are not finite become null.
void writeJson(const std::vector<CaseResult>& results, std::ostream& out);

}  // namespace tissue_contact
