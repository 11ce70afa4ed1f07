#include "validation/validation_table.h"

#include <cmath>
#include <cstdio>
#include <iomanip>
#include <sstream>

namespace tissue_contact {
namespace {

std::string number(double value) {
  std::ostringstream text;
  text << std::setprecision(5) << value;
  return text.str();
}

std::string expectation(const Check& check) {
  const char* const sign = check.kind == Check::Kind::kAtMost    ? "<= "
                           : check.kind == Check::Kind::kAtLeast ? ">= "
                                                                 : "";
  return sign + number(check.expected);
}

void printCheck(const Check& check, std::ostream& out) {
  const bool near = check.kind == Check::Kind::kNear;
  out << "  " << (check.passed() ? "pass" : "FAIL") << "  " << std::left << std::setw(58) << check.quantity << ' '
      << std::setw(8) << check.unit << ' ' << std::right << std::setw(12) << expectation(check) << std::setw(12)
      << number(check.got) << std::setw(12) << (near ? number(check.got - check.expected) : "") << std::setw(11)
      << (near ? number(check.tolerance) : "") << "  " << check.source << '\n';
}

void printStudy(const ConvergenceStudy& study, std::ostream& out) {
  out << "        " << study.quantity << " over " << study.parameter << ", limit " << number(study.limit) << ' '
      << study.unit << ":";
  for (const ConvergenceStudy::Level& level : study.levels) {
    out << "  " << number(level.size) << " -> " << number(level.value);
  }
  out << "; observed order " << number(study.observedOrder()) << '\n';
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
      result += code;
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string jsonNumber(double value) {
  if (!std::isfinite(value)) return "null";
  std::ostringstream text;
  text << std::setprecision(17) << value;
  return text.str();
}

const char* jsonBool(bool value) { return value ? "true" : "false"; }

void writeCheck(const Check& check, std::ostream& out) {
  static const char* const kinds[] = {"near", "at_most", "at_least"};
  out << "{\"quantity\": " << quoted(check.quantity) << ", \"unit\": " << quoted(check.unit) << ", \"kind\": \""
      << kinds[static_cast<int>(check.kind)] << "\", \"expected\": " << jsonNumber(check.expected)
      << ", \"got\": " << jsonNumber(check.got) << ", \"tolerance\": " << jsonNumber(check.tolerance)
      << ", \"source\": " << quoted(check.source) << ", \"passed\": " << jsonBool(check.passed()) << '}';
}

void writeStudy(const ConvergenceStudy& study, std::ostream& out) {
  out << "{\"quantity\": " << quoted(study.quantity) << ", \"unit\": " << quoted(study.unit)
      << ", \"parameter\": " << quoted(study.parameter) << ", \"limit\": " << jsonNumber(study.limit)
      << ", \"levels\": [";
  const char* separator = "";
  for (const ConvergenceStudy::Level& level : study.levels) {
    out << separator << '[' << jsonNumber(level.size) << ", " << jsonNumber(level.value) << ']';
    separator = ", ";
  }
  out << "], \"observed_order\": " << jsonNumber(study.observedOrder()) << '}';
}

template <typename Items, typename Write>
void writeList(const char* name, const Items& items, std::ostream& out, const Write& write) {
  out << ", \"" << name << "\": [";
  const char* separator = "\n    ";
  for (const auto& item : items) {
    out << separator;
    write(item, out);
    separator = ",\n    ";
  }
  out << ']';
}

}  // namespace

void printCase(const CaseResult& result, std::ostream& out) {
  out << (result.passed() ? "pass" : "FAIL") << "  " << result.name << ": " << result.title << '\n';
  for (const Check& check : result.report.checks()) printCheck(check, out);
  for (const ConvergenceStudy& study : result.report.studies()) printStudy(study, out);
  for (const std::string& note : result.report.notes()) out << "        " << note << '\n';
  if (!result.failure.empty()) out << "        stopped: " << result.failure << '\n';
  if (result.failure.empty() && result.report.checks().empty()) out << "        no checks were made\n";
}

void writeJson(const std::vector<CaseResult>& results, std::ostream& out) {
  bool passed = !results.empty();
  for (const CaseResult& result : results) passed = passed && result.passed();
  out << "{\"passed\": " << jsonBool(passed) << ", \"cases\": [";
  const char* separator = "\n  ";
  for (const CaseResult& result : results) {
    out << separator << "{\"name\": " << quoted(result.name) << ", \"title\": " << quoted(result.title)
        << ", \"passed\": " << jsonBool(result.passed()) << ", \"failure\": " << quoted(result.failure);
    writeList("checks", result.report.checks(), out, writeCheck);
    writeList("studies", result.report.studies(), out, writeStudy);
    writeList("notes", result.report.notes(), out, [](const std::string& n, std::ostream& o) { o << quoted(n); });
    out << '}';
    separator = ",\n  ";
  }
  out << "]}\n";
}

}  // namespace tissue_contact
