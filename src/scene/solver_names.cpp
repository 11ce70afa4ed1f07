#include <stdexcept>
#include <string>

#include "tissue_contact/scene/scene.h"

namespace tissue_contact {
namespace {

template <typename Value>
struct Named {
  Value value;
  const char* name;
};

constexpr Named<SolverMethod> kMethods[] = {{SolverMethod::kPredictorCorrector, "predictor_corrector"},
                                            {SolverMethod::kReference, "reference"},
                                            {SolverMethod::kCone4, "cone4"},
                                            {SolverMethod::kPolyhedral, "polyhedral"},
                                            {SolverMethod::kCondensedLcp, "condensed_lcp"},
                                            {SolverMethod::kImpulse, "impulse"}};

constexpr Named<RelaxationKind> kRelaxations[] = {{RelaxationKind::kGaussSeidel, "gauss_seidel"},
                                                  {RelaxationKind::kCholesky, "cholesky"}};

template <typename Value, std::size_t kCount>
const char* nameOf(Value value, const Named<Value> (&all)[kCount], const char* what) {
  for (const Named<Value>& named : all) {
    if (named.value == value) return named.name;
  }
  throw std::invalid_argument(std::string(what) + " number " + std::to_string(static_cast<int>(value)) +
                              " does not exist; use a named one");
}

template <typename Value, std::size_t kCount>
Value valueOf(const std::string& name, const Named<Value> (&all)[kCount], const char* what) {
  std::string known;
  for (const Named<Value>& named : all) {
    if (named.name == name) return named.value;
    known += (known.empty() ? "" : ", ") + std::string(named.name);
  }
  throw std::invalid_argument("unknown " + std::string(what) + " \"" + name + "\"; it must be one of " + known);
}

}  // namespace

const char* solverMethodName(SolverMethod method) { return nameOf(method, kMethods, "solver method"); }
SolverMethod solverMethodByName(const std::string& name) { return valueOf(name, kMethods, "solver method"); }
const char* relaxationName(RelaxationKind relaxation) { return nameOf(relaxation, kRelaxations, "relaxation"); }
RelaxationKind relaxationByName(const std::string& name) { return valueOf(name, kRelaxations, "relaxation"); }

}  // namespace tissue_contact
