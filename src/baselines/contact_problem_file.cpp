#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string_view>

#include "tissue_contact/baselines/delassus.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/friction/friction_law.h"

namespace tissue_contact {
namespace {

/// What so many contacts take with 17 digits per number; the text is held in memory.
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{2} << 30U;

/// The words of a file one by one, with the place for messages.
class Words {
 public:
  Words(const std::string& file, const std::string& text) : file_(file), rest_(text) {}

  /// The next word; empty at the end.
  std::string_view next() {
    skipBlanks();
    std::size_t length = 0;
    while (length < rest_.size() && !isBlank(rest_[length]) && rest_[length] != '#') ++length;
    word_ = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word_;
  }

  void expect(const char* word) {
    if (next() != word) fail(std::string("'") + word + "'");
  }

  double number(const std::string& what) {
    const std::optional<double> value = toDouble(next());
    if (!value || !std::isfinite(*value)) fail("a finite number for " + what);
    return *value;
  }

  int integer(const std::string& what, int low, int high) {
    const std::optional<std::int64_t> value = toInteger(next());
    if (!value || *value < low || *value > high) {
      fail("an integer from " + std::to_string(low) + " to " + std::to_string(high) + " for " + what);
    }
    return static_cast<int>(*value);
  }

  /// Refuses a count of words that the rest of the file cannot hold, before memory is taken for them.
  void requireRoomFor(double words, const std::string& what) const {
    if (words > 0.5 * static_cast<double>(rest_.size()) + 1.0) fail("a file long enough to hold " + what);
  }

  [[noreturn]] void fail(const std::string& expected) const {
    constexpr std::size_t kShown = 40;
    const std::string word = word_.empty() ? "the end of the file" : "'" + std::string(word_.substr(0, kShown)) + "'";
    throw std::invalid_argument("contact problem file '" + file_ + "', line " + std::to_string(line_) + ": found " +
                                word + ", expected " + expected);
  }

 private:
  static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }

  void skipBlanks() {
    bool comment = false;
    while (!rest_.empty() && (comment || isBlank(rest_[0]) || rest_[0] == '#')) {
      if (rest_[0] == '\n') ++line_;
      comment = rest_[0] == '#' || (comment && rest_[0] != '\n');
      rest_.remove_prefix(1);
    }
  }

  std::string file_;
  std::string_view rest_;
  std::string_view word_;
  int line_ = 1;
};

Eigen::MatrixXd readMatrix(Words& words, int size) {
  const std::string_view kind = words.next();
  const bool dense = kind == "dense";
  if (!dense && kind != "sparse") words.fail("'dense' or 'sparse'");
  if (dense) words.requireRoomFor(static_cast<double>(size) * size, "W dense");
  const int entries = dense ? 0 : words.integer("the number of entries of W", 0, std::numeric_limits<int>::max());
  if (!dense) words.requireRoomFor(3.0 * entries, "W sparse");
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(size, size);
  for (int i = 0; dense && i < size; ++i) {
    for (int j = 0; j < size; ++j) W(i, j) = words.number("an entry of W");
  }
  for (int k = 0; k < entries; ++k) {
    const int i = words.integer("a row of W", 0, size - 1);
    const int j = words.integer("a column of W", 0, size - 1);
    W(i, j) += words.number("an entry of W");
  }
  if (!W.allFinite()) words.fail("entries of W whose sums are finite");
  return W;
}

/// The one coefficient the format has room for.
double fileCoefficient(const CoulombLaw& law, bool was_sliding, ContactState state) {
  if (law.anisotropic != nullptr) {
    return -law.kinetic_factor * law.anisotropic->slidingForce(Vector2::UnitX()).x();
  }
  return was_sliding || state == ContactState::kKinetic ? law.mu_kinetic : law.mu_static;
}

void writeMatrix(std::ostream& stream, const Eigen::MatrixXd& W) {
  const auto entries = (W.array() != 0.0).count();
  if (3 * entries >= W.size()) {
    stream << "W dense\n";
    for (Eigen::Index i = 0; i < W.rows(); ++i) {
      for (Eigen::Index j = 0; j < W.cols(); ++j) stream << W(i, j) << (j + 1 < W.cols() ? ' ' : '\n');
    }
    return;
  }
  stream << "W sparse " << entries << '\n';
  for (Eigen::Index i = 0; i < W.rows(); ++i) {
    for (Eigen::Index j = 0; j < W.cols(); ++j) {
      if (W(i, j) != 0.0) stream << i << ' ' << j << ' ' << W(i, j) << '\n';
    }
  }
}

}  // namespace

DelassusProblem readContactProblem(const std::string& file) {
  const std::string text = readFile(file, "contact problem file", kMaxFileBytes);
  Words words(file, text);
  words.expect("FC3D");
  words.expect("1");
  words.expect("n");
  const int contacts = words.integer("the number of contacts", 1, kMostDenseContacts);
  words.requireRoomFor(4.0 * contacts, "q and mu");
  words.expect("W");
  DelassusProblem problem;
  problem.W = readMatrix(words, 3 * contacts);
  words.expect("q");
  problem.q.resize(problem.W.rows());
  for (Eigen::Index i = 0; i < problem.q.size(); ++i) problem.q[i] = words.number("an entry of q");
  words.expect("mu");
  problem.laws.resize(contacts);
  for (CoulombLaw& law : problem.laws) {
    law.mu_static = law.mu_kinetic = words.number("a coefficient of friction");
    if (!(law.mu_static >= 0.0)) words.fail("a coefficient of friction >= 0");
  }
  problem.was_sliding.assign(contacts, false);
  if (!words.next().empty()) words.fail("the end of the file");
  return problem;
}

void writeContactProblem(std::ostream& stream, const DelassusProblem& problem,
                         const std::vector<ContactState>& states) {
  const auto precision = stream.precision(std::numeric_limits<double>::max_digits10);
  stream << "FC3D 1\nn " << problem.contacts() << '\n';
  writeMatrix(stream, problem.W);
  stream << "q\n";
  for (Eigen::Index c = 0; c < problem.contacts(); ++c) stream << problem.q.segment<3>(3 * c).transpose() << '\n';
  stream << "mu\n";
  for (Eigen::Index c = 0; c < problem.contacts(); ++c) {
    if (problem.laws[c].anisotropic != nullptr) stream << "# directional law: its forward coefficient alone\n";
    stream << fileCoefficient(problem.laws[c], problem.was_sliding[c], states[c]) << '\n';
  }
  stream.precision(precision);
}

}  // namespace tissue_contact
