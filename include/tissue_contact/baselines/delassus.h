/// @file
/// Room `baselines`: the contact problem with the tissues eliminated, u = W r + q with W the Delassus matrix J A^-1 J',
/// and the solvers that work on it. A step's contact problem, or one read from a file, in; impulses and velocities out.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tissue_contact/baselines/solver_description.h"
#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// Contacts of a dense problem: W takes 650 MB at this number, and is not made for more, from a file or from a step.
constexpr int kMostDenseContacts = 3000;

/// Per contact three rows (n, t1, t2): u = W r + q, 0 <= u_n  _|_  r_n >= 0, Coulomb friction. u_n here has the
/// velocity that closes the gap already taken off (u_n + normal_compliance r_n - required_u_n of ContactRow).
struct DelassusProblem {
  Eigen::MatrixXd W;              ///< 3n x 3n, 1/kg; symmetric for tissue, not always in files
  VectorX q;                      ///< 3n, m/s
  std::vector<CoulombLaw> laws;   ///< n
  std::vector<bool> was_sliding;  ///< n; such contacts have only the kinetic limit (hysteresis)

  int contacts() const { return static_cast<int>(laws.size()); }
};

/// In: warm start; out: the answer.
struct DelassusSolution {
  VectorX r;                         ///< 3n, N s
  VectorX u;                         ///< 3n, m/s
  std::vector<ContactState> states;  ///< n
};

/// The measures of how wrong an answer is; u is recomputed as W r + q.
struct DelassusResiduals {
  double scaled_natural_map = 0.0;  ///< |F| over all contacts, F = r' - P_K(r' - (u' + mu |u'_T| n)), r' = r w / |q|,
                                    ///< u' = u / |q|, w = tr W / 3n; dimensionless
  double penetration_m_per_s = 0.0;
  double adhesion_n_s = 0.0;
  double complementarity_j = 0.0;
  double cone_violation_n_s = 0.0;
  double dissipation_defect_j = 0.0;  ///< sum |mu r_n |u_t| + r_t . u_t|
  double friction_power_j = 0.0;      ///< sum r_t . u_t: never > 0 for a true answer
  double kinetic_angle_rad = 0.0;     ///< worst angle between r_t and -u_t of sliding contacts
  double static_slip_m_per_s = 0.0;   ///< worst |u_t| of contacts inside their cone
};

DelassusResiduals computeResiduals(const DelassusProblem& problem, const VectorX& r);

struct DelassusReport {
  int iterations = 0;
  bool converged = false;   ///< the scaled natural map met the tolerance
  bool overflowed = false;  ///< on the way to an answer: r = 0 then, all open, and not converged
  DelassusResiduals residuals;
};

/// Solves a Delassus problem by the method of the description (all but kImpulse, which needs a step; relaxation does
/// not matter here, W is exact). `tolerance` is that of the scaled natural map.
/// @throws std::invalid_argument for a method that does not apply, sizes that do not match, values that are not finite.
DelassusReport solveDelassus(const DelassusProblem& problem, const SolverDescription& description,
                             DelassusSolution& solution);

/// A step's problem with its bodies eliminated by sparse Cholesky: W = J A^-1 J' with the rows' compliances, q = J A^-1 b - u_tool - required_u_n
/// n. Contacts on nodes that cannot move get zero rows (q too): r = 0, open.
/// @throws std::runtime_error naming the body whose A is not positive definite.
/// @throws std::invalid_argument for more than kMostDenseContacts.
DelassusProblem makeDelassusProblem(const ContactProblem& contacts);

/// Plain-text contact problem files ("FC3D 1"). Anisotropic laws do not fit the format: `mu` is then the kinetic
/// coefficient along axis 1; where static and kinetic differ, the coefficient that applies to the contact's last state.
/// Reading: # comments, W dense or sparse. At most kMostDenseContacts, and no more memory than a file of that size can
/// fill.
/// @throws std::invalid_argument naming the file, the line, the word found and what was expected.
DelassusProblem readContactProblem(const std::string& file);
/// Writing: 17 digits, so that reading gives the same numbers back.
/// @param states per contact.
void writeContactProblem(std::ostream& stream, const DelassusProblem& problem, const std::vector<ContactState>& states);

}  // namespace tissue_contact
