#include "simulation/load_watch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/mesh/triangle_mesh.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {
namespace {

/// At once: before any of it relaxes.
double largestModulus(const TissueDescription& description) {
  double largest = description.material.youngs_modulus_pa;
  for (const TissueRegion& region : description.regions) {
    largest = std::max(largest, region.material.youngs_modulus_pa);
  }
  double at_once = 1.0;
  for (const PronyTerm& term : description.material.prony_series) at_once += term.modulus_ratio;
  return at_once * largest;
}

std::vector<double> nodeAreas(const Tissue& tissue) {
  std::vector<double> areas(tissue.nodeCount(), 0.0);
  for (const Triangle& triangle : tissue.surface()) {
    const double third = triangleArea(tissue.restPositions(), triangle) / 3.0;
    for (const int node : triangle) areas[node] += third;
  }
  return areas;
}

/// Whether an instrument touches with several links, none of which gives way.
bool mayBeJaws(const Instrument& instrument) {
  return instrument.contactLinks().size() > 1 && instrument.compliantJoints().empty();
}

}  // namespace

LoadWatch::LoadWatch(const Scene& scene, const std::vector<Tissue>& tissues) {
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    Body& body = bodies_.emplace_back();
    body.tissue = &tissues[t];
    body.law = scene.tissues[t].material.model;
    body.mesh = meshOf(tissues[t], body.law);
    setMaterials(static_cast<int>(t), scene.tissues[t]);
  }
}

void LoadWatch::setMaterials(int index, const TissueDescription& description) {
  Body& body = bodies_[index];
  body.modulus_pa = largestModulus(description);
  body.poissons_ratio = description.material.poissons_ratio;
  body.poissons_ratio_of_regions.clear();
  for (const TissueRegion& region : description.regions) {
    body.poissons_ratio_of_regions.push_back(region.material.poissons_ratio - body.poissons_ratio);
  }
}

LoadWatch::Mesh LoadWatch::meshOf(const Tissue& tissue, ElasticModel law) {
  const std::vector<Tetrahedron>& elements = tissue.tetrahedra();
  const auto nodes = static_cast<std::size_t>(tissue.nodeCount());
  Mesh mesh;
  mesh.node_area = nodeAreas(tissue);
  mesh.node_seen.assign(nodes, 0);
  mesh.element_seen.assign(elements.size(), 0);
  if (hasRange(law)) mesh.strains.resize(elements.size());
  mesh.first_of_node.assign(nodes + 1, 0);
  for (const Tetrahedron& element : elements) {
    for (const int node : element) ++mesh.first_of_node[node + 1];
  }
  for (std::size_t i = 0; i < nodes; ++i) mesh.first_of_node[i + 1] += mesh.first_of_node[i];
  mesh.elements_of_node.resize(mesh.first_of_node.back());
  std::vector<int> next(mesh.first_of_node.begin(), mesh.first_of_node.end() - 1);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (const int node : elements[e]) mesh.elements_of_node[next[node]++] = static_cast<int>(e);
  }
  return mesh;
}

void LoadWatch::swapMesh(int index, Mesh& mesh) { std::swap(bodies_[index].mesh, mesh); }

void LoadWatch::check(const std::vector<SolvedContact>& contacts, const std::vector<NodalVectors>& positions,
                      ImplausibleLoad& load, LawError& law_error) {
  load = ImplausibleLoad();
  law_error = LawError();
  worst_volume_ = 0.0;
  for (std::size_t first = 0, end = 0; first < contacts.size(); first = end) {
    const ContactKey& key = contacts[first].contact.key;
    Body& body = bodies_[key.tissue];
    const NodalVectors& x = positions[key.tissue];
    ++checks_;
    double force = 0.0;
    double area = 0.0;
    UnderTool sum;  // times force
    std::size_t strongest = first;
    for (end = first; end < contacts.size(); ++end) {
      const SolvedContact& contact = contacts[end];
      if (contact.contact.key.tissue != key.tissue || contact.contact.key.instrument != key.instrument) break;
      if (contact.state == ContactState::kOpen) continue;
      force += contact.force_on_tissue_n.norm();
      if (contact.force_on_tissue_n.norm() > contacts[strongest].force_on_tissue_n.norm()) strongest = end;
      for (int i = 0; i < 3; ++i) {
        const int node = contact.contact.nodes[i];
        if (contact.contact.weights[i] == 0.0 || body.mesh.node_seen[node] == checks_) continue;
        body.mesh.node_seen[node] = checks_;
        area += body.mesh.node_area[node];
        checkElements(body, node, x, key.instrument, key.tissue, load);
      }
      if (body.mesh.strains.empty()) continue;
      const UnderTool under = underTool(body, contact.contact);
      sum.strain += contact.force_on_tissue_n.norm() * under.strain;
      sum.poissons_ratio += contact.force_on_tissue_n.norm() * under.poissons_ratio;
    }
    if (force > 0.0) add(key, body, {sum.strain / force, sum.poissons_ratio / force}, law_error);
    if (!(area > 0.0)) continue;
    const double pressure = force / area;
    const bool is_of_finding =
        load.inverted_elements > 0 && load.tissue == key.tissue && load.instrument == key.instrument;
    if (load.inverted_elements > 0 && !is_of_finding) continue;  // one finding: the worst element tells of whom
    if (!is_of_finding && !(pressure > load.pressure_pa)) continue;
    load.pressure_pa = pressure;
    load.modulus_pa = body.modulus_pa;
    if (!(pressure > kMostPressure * body.modulus_pa) || load.inverted_elements > 0) continue;
    load.found = true;
    load.tissue = key.tissue;
    load.instrument = key.instrument;
    load.p_W = contacts[strongest].contact.p_WC;
  }
}

void LoadWatch::checkElements(Body& body, int node, const NodalVectors& x, int instrument, int tissue,
                              ImplausibleLoad& load) {
  const std::vector<Tetrahedron>& elements = body.tissue->tetrahedra();
  for (int i = body.mesh.first_of_node[node]; i < body.mesh.first_of_node[node + 1]; ++i) {
    const int e = body.mesh.elements_of_node[i];
    if (body.mesh.element_seen[e] == checks_) continue;
    body.mesh.element_seen[e] = checks_;
    const NodalVectors& rest = body.tissue->restPositions();
    const double rest_volume = signedVolume(rest, elements[e]);
    const double volume = signedVolume(x, elements[e]) / rest_volume;
    if (!body.mesh.strains.empty()) {
      const Matrix3 F = edgeMatrix(x, elements[e]) * edgeMatrix(rest, elements[e]).inverse();
      body.mesh.strains[e] = {rest_volume * equivalentStrain(F), rest_volume};
    }
    if (!(volume < kInsideOut)) continue;
    ++load.inverted_elements;
    if (!(volume < worst_volume_)) continue;
    worst_volume_ = volume;
    load.found = true;
    load.tissue = tissue;
    load.instrument = instrument;
    load.p_W = Vector3::Zero();
    for (const int corner : elements[e]) load.p_W += 0.25 * x.col(corner);
  }
}

/// Of elements that checkElements() has seen.
LoadWatch::UnderTool LoadWatch::underTool(const Body& body, const Contact& contact) {
  UnderTool mean;
  const std::vector<int>& regions = body.tissue->elementRegions();
  for (int k = 0; k < 3; ++k) {
    if (contact.weights[k] == 0.0) continue;
    const int node = contact.nodes[k];
    UnderTool sum;  // times volume
    double volume = 0.0;
    for (int i = body.mesh.first_of_node[node]; i < body.mesh.first_of_node[node + 1]; ++i) {
      const int e = body.mesh.elements_of_node[i];
      const int region = regions.empty() ? -1 : regions[e];
      sum.strain += body.mesh.strains[e].times_volume;
      if (region >= 0) sum.poissons_ratio += body.mesh.strains[e].volume * body.poissons_ratio_of_regions[region];
      volume += body.mesh.strains[e].volume;
    }
    mean.strain += std::abs(contact.weights[k]) * sum.strain / volume;
    mean.poissons_ratio += std::abs(contact.weights[k]) * sum.poissons_ratio / volume;
  }
  return mean;
}

void LoadWatch::add(const ContactKey& key, const Body& body, const UnderTool& mean, LawError& law_error) {
  const double relative = likelyLawError(body.law, body.poissons_ratio + mean.poissons_ratio, mean.strain);
  if (!hasRange(body.law)) return;
  if (law_error.tissue >= 0 && !(std::abs(relative) > std::abs(law_error.relative))) return;
  law_error = {key.tissue, key.instrument, mean.strain, relative};
}

std::string implausibleLoadText(const Simulator& simulator) {
  const ImplausibleLoad& load = simulator.report().implausible_load;
  const std::string by =
      load.instrument < 0 ? "another tissue" : "'" + simulator.instruments()[load.instrument].name() + "'";
  std::ostringstream text;
  text.precision(3);
  text << "tissue '" << simulator.tissues()[load.tissue].name() << "' cannot bear what " << by << " does to it at ("
       << load.p_W.x() << ", " << load.p_W.y() << ", " << load.p_W.z() << ") m: ";
  if (load.inverted_elements > 0) text << load.inverted_elements << " elements turned inside out, ";
  text << "mean contact pressure " << load.pressure_pa << " Pa at a Young's modulus of " << load.modulus_pa
       << " Pa; the forces are not to be trusted. ";
  if (simulator.report().stop == StopReason::kTimeBudget) {
    text << "The solver had no time to finish this step (" << simulator.report().iterations
         << " iterations), which does this by itself: let the machine keep up first, by fewer nodes, a larger "
            "step.max_lag_s or solver.time_budget_s; if it is told all the same, check where the tool is";
    return text.str();
  }
  const bool is_for_large_strain = simulator.scene().tissues[load.tissue].material.model == ElasticModel::kNeoHookean;
  text << "Check where the tool is (base_pose, joint_names, units), and whether the log told of flat elements in the "
          "mesh there; deep or wide motion needs "
       << (is_for_large_strain ? "" : "material.model neo_hookean and ")
       << "smaller cells under the tool, and edges turn elements inside out with any: forces that stay the same with "
          "smaller cells are right";
  if (load.instrument >= 0 && mayBeJaws(simulator.instruments()[load.instrument])) {
    text << "; if jaws close on it, compliant_joints limits what they squeeze with";
  }
  return text.str();
}

}  // namespace tissue_contact
