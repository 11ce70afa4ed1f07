#include "validation/validate.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "tissue_contact/core/command_line.h"
#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/core/whole_file.h"
#include "validation/cases.h"
#include "validation/validation_table.h"

namespace tissue_contact {
namespace {

constexpr const char* kUsage =
    "usage: tissue_contact_validate [--case NAME]... [--json FILE] [--list]\n"
    "Runs closed forms and hard cases through the product's own pipeline and prints, per quantity: verdict, what it "
    "is,\n"
    "unit, expected, got, error, tolerance, source. Exit code 0: all within tolerance; 1: not; 2: wrong arguments, or "
    "results\n"
    "that could not be written.\n"
    "  --case NAME  this case only; may be repeated\n"
    "  --json FILE  the same results, with convergence studies, as JSON; replaced when all cases have run\n"
    "  --list       names and titles of all cases\n";

struct Options {
  std::vector<const ValidationCase*> cases;
  std::string json;
  bool list = false;
  bool help = false;
};

const ValidationCase* caseByName(const std::string& name) {
  const std::vector<ValidationCase>& all = validationCases();
  const auto found = std::find_if(all.begin(), all.end(), [&](const ValidationCase& one) { return name == one.name; });
  if (found != all.end()) return &*found;
  std::vector<std::string> names;
  names.reserve(all.size());
  for (const ValidationCase& one : all) names.emplace_back(one.name);
  throw std::invalid_argument("--case '" + name + "' is unknown; " + suggestion(name, names) +
                              "there are: " + joined(names));
}

Options parseOptions(const std::vector<std::string>& arguments) {
  const CommandLine line(arguments, {{"--json"}, {"--list"}, {"--case"}});
  Options options;
  options.help = line.help();
  options.list = line.has("--list");
  options.json = line.value("--json");
  if (options.list && line.has("--json"))
    throw std::invalid_argument("--json does not go with --list, which runs no case");
  for (const std::string& name : line.all("--case")) options.cases.push_back(caseByName(name));
  if (options.cases.empty()) {
    for (const ValidationCase& one : validationCases()) options.cases.push_back(&one);
  }
  return options;
}

/// A bar over all cases; `share` of the one that runs is done.
void showProgress(std::size_t done, double share, std::size_t count, const char* name, std::ostream& progress) {
  constexpr int kWidth = 30;
  const double all = (static_cast<double>(done) + share) / static_cast<double>(count);
  const int filled = static_cast<int>(all * kWidth);
  progress << "\r[" << std::string(filled, '=') << std::string(kWidth - filled, ' ') << "] " << done + 1 << '/' << count
           << ' ' << name << "\033[K" << std::flush;
}

CaseResult runCase(const ValidationCase& one, std::size_t done, std::size_t count, std::ostream* bar) {
  const auto show = [=, &one](double share) {
    if (bar != nullptr) showProgress(done, share, count, one.name, *bar);
  };
  show(0.0);
  CaseResult result{one.name, one.title, Report(show), ""};
  try {
    one.run(result.report);
  } catch (const std::exception& error) {
    result.failure = error.what();
  }
  if (bar != nullptr) *bar << "\r\033[K" << std::flush;
  return result;
}

int runCases(const Options& options, std::ostream& out, std::ostream* bar) {
  std::optional<WholeFile> json;  // from before the long run, so that a wrong path costs nothing
  if (!options.json.empty()) json.emplace(options.json);
  std::vector<CaseResult> results;
  for (const ValidationCase* const one : options.cases) {
    results.push_back(runCase(*one, results.size(), options.cases.size(), bar));
    printCase(results.back(), out);
    requireWritten(out);
  }
  if (json) {
    writeJson(results, json->stream());
    json->commit();
  }
  const auto passed = std::count_if(results.begin(), results.end(), [](const CaseResult& r) { return r.passed(); });
  out << passed << " of " << results.size() << " cases pass\n";
  return passed == static_cast<std::ptrdiff_t>(results.size()) ? 0 : 1;
}

}  // namespace

int runValidate(const std::vector<std::string>& arguments, std::ostream& out, std::ostream& messages, bool show_bar) {
  try {
    const Options options = parseOptions(arguments);
    int code = 0;
    if (options.help) {
      out << kUsage;
    } else if (options.list) {
      for (const ValidationCase* const one : options.cases) out << one->name << ": " << one->title << '\n';
    } else {
      code = runCases(options, out, show_bar ? &messages : nullptr);
    }
    requireWritten(out);
    return code;
  } catch (const std::invalid_argument& error) {
    messages << "tissue_contact_validate: " << error.what() << '\n' << kUsage;
  } catch (const std::exception& error) {
    messages << "tissue_contact_validate: " << error.what() << '\n';
  }
  return 2;
}

}  // namespace tissue_contact
