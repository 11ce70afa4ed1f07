#include "mesh/reader/flat_triangles.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "mesh/reader/mesh_cleanup.h"

namespace tissue_contact {
namespace {

class Absorber {
 public:
  explicit Absorber(TriangleMesh& mesh) : mesh_(mesh), at_flat_(static_cast<std::size_t>(mesh.vertices.cols()), false) {
    resolved_ = kSinglePrecision * mesh.vertices.cwiseAbs().maxCoeff();
  }

  void run() {
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (!isFlat(mesh_.triangles[t])) continue;
      flat_.push_back(t);
      for (const int v : mesh_.triangles[t]) at_flat_[static_cast<std::size_t>(v)] = true;
    }
    if (flat_.empty()) return;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) file(t);
    for (std::size_t i = 0; i < flat_.size(); ++i) absorb(flat_[i]);  // which grows by those that wait for others
  }

 private:
  using Edge = std::pair<int, int>;

  static Edge edge(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

  Vector3 along(int a, int b) const { return mesh_.vertices.col(b) - mesh_.vertices.col(a); }
  Vector3 normal(const Triangle& t) const { return along(t[0], t[1]).cross(along(t[0], t[2])); }

  std::size_t longestSide(const Triangle& t) const {
    std::size_t longest = 0;
    for (const std::size_t side : {1u, 2u}) {
      if (length(t, side) > length(t, longest)) longest = side;
    }
    return longest;
  }
  double length(const Triangle& t, std::size_t side) const { return along(t[side], t[(side + 1) % 3]).norm(); }

  bool isFlat(const Triangle& t) const {
    const double longest = length(t, longestSide(t));
    return !(normal(t).norm() > longest * std::max(2.0 * kFlatArea * longest, std::min(resolved_, 1e-3 * longest)));
  }

  template <class Change>
  void forEdges(std::size_t t, const Change& change) {
    const Triangle& corners = mesh_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const Edge e = edge(corners[k], corners[(k + 1) % 3]);
      if (at_flat_[static_cast<std::size_t>(e.first)] || at_flat_[static_cast<std::size_t>(e.second)]) change(e);
    }
  }
  void file(std::size_t t) {
    forEdges(t, [&](const Edge& e) { users_[e].push_back(t); });
  }
  void takeOut(std::size_t t) {
    forEdges(t, [&](const Edge& e) {
      std::vector<std::size_t>& users = users_[e];
      users.erase(std::remove(users.begin(), users.end(), t), users.end());
    });
  }
  bool isUsed(const Edge& e) const {
    const auto found = users_.find(e);
    return found != users_.end() && !found->second.empty();
  }

  /// The triangle with one of its corners replaced.
  Triangle with(Triangle t, int corner, int by) const {
    std::replace(t.begin(), t.end(), corner, by);
    return t;
  }
  bool isLike(const Triangle& part, const Triangle& whole) const {
    return !isFlat(part) && normal(part).dot(normal(whole)) > 0.0;
  }

  void absorb(std::size_t flat) {
    const Triangle t = mesh_.triangles[flat];
    if (!isFlat(t)) return;
    const std::size_t side = longestSide(t);
    const int a = t[side];
    const int c = t[(side + 1) % 3];
    const int b = t[(side + 2) % 3];
    const std::vector<std::size_t>& users = users_[edge(a, c)];
    if (users.size() != 2) return;
    const std::size_t other = users[users[0] == flat ? 1 : 0];
    const Triangle whole = mesh_.triangles[other];
    const int across = *std::find_if(whole.begin(), whole.end(), [&](int v) { return v != a && v != c; });
    const Triangle one = with(whole, c, b);
    const Triangle two = with(whole, a, b);
    if (isFlat(whole) || across == b || isUsed(edge(b, across)) || !isLike(one, whole) || !isLike(two, whole)) return;
    takeOut(flat);
    takeOut(other);
    mesh_.triangles[other] = one;
    mesh_.triangles[flat] = two;
    file(other);
    file(flat);
    for (const Edge& e : {edge(a, b), edge(b, c)}) {
      for (const std::size_t next : users_[e]) {
        if (isFlat(mesh_.triangles[next])) flat_.push_back(next);
      }
    }
  }

  static constexpr double kSinglePrecision = 0x1p-21;  // as of nodes in one place

  TriangleMesh& mesh_;
  double resolved_ = 0.0;
  std::vector<bool> at_flat_;
  std::vector<std::size_t> flat_;
  std::map<Edge, std::vector<std::size_t>>
      users_;  ///< triangles at the edges that begin or end at corners of flat ones
};

}  // namespace

void absorbFlatTriangles(TriangleMesh& mesh) {
  if (!mesh.triangles.empty()) Absorber(mesh).run();
}

}  // namespace tissue_contact
