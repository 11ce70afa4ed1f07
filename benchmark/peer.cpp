#include "benchmark/peer.h"

#include <cmath>
#include <stdexcept>

#include "benchmark/bullet_peer.h"

namespace tissue_contact {

#ifdef TISSUE_CONTACT_HAS_BULLET

namespace {

PeerScene peerScene(const BenchmarkScene& scene, const Settings& settings, const PressDragMotion& motion, bool damped) {
  const Simulator simulator(withSettings(scene.scene, settings), scene.environment);
  const Tissue& tissue = simulator.tissues().at(0);
  const TissueDescription& description = scene.scene.tissues.at(0);
  PeerScene peer;
  peer.rest = tissue.restPositions();
  peer.tetrahedra = tissue.tetrahedra();
  peer.surface = tissue.surface();
  peer.fixed = tissue.fixed();
  peer.youngs_modulus_pa = description.material.youngs_modulus_pa;
  peer.poissons_ratio = description.material.poissons_ratio;
  peer.density = description.material.density_kg_per_m3;
  peer.damping_s = damped ? description.damping.stiffness_s : 0.0;
  peer.mu = kPressDragMu;
  peer.sphere_radius_m = kProbeRadius;
  peer.sphere_centre = [motion](double time_s) -> Vector3 { return pressDragBase() + motion.jointsAt(time_s); };
  peer.dt_s = settings.dt_s;
  peer.steps = static_cast<int>(std::lround(motion.duration_s() / settings.dt_s));
  return peer;
}

}  // namespace

bool hasPeer() { return true; }

PeerResult runPeer(const BenchmarkScene& scene, const Settings& settings, const PressDragMotion& motion, bool damped) {
  const PeerRun run = runBulletPeer(peerScene(scene, settings, motion, damped));
  PeerResult result;
  result.name = damped ? "bullet" : "bullet_undamped";
  result.how = run.how;
  result.run.nodes = run.nodes;
  result.run.step_s = run.step_seconds;
  result.run.simulated_s = settings.dt_s * static_cast<double>(run.step_seconds.size());
  const long per_sample = std::lround(motion.sample_s / settings.dt_s);
  for (std::size_t k = static_cast<std::size_t>(per_sample); k <= run.forces_n.size();
       k += static_cast<std::size_t>(per_sample)) {
    Wrench wrench;  // the sphere's centre is the tip, whose axes are the world's; the peer gives no moment
    wrench.force = run.forces_n[k - 1];
    result.run.times_s.push_back(settings.dt_s * static_cast<double>(k));
    result.run.wrenches.push_back({wrench});
  }
  return result;
}

#else

bool hasPeer() { return false; }

PeerResult runPeer(const BenchmarkScene&, const Settings&, const PressDragMotion&, bool) {
  throw std::logic_error("this build has no peer");
}

#endif

std::vector<Settings> peerSizes(const ScenePlan& plan, const SceneOptions& options) {
  std::vector<Settings> sizes = {shippedSettings(plan.scene)};
  if (!options.quick && !plan.meshes.empty()) {
    Settings longer = sizes.front();
    longer.dt_s *= 2.0;
    Settings finer = sizes.front();
    finer.cells = plan.meshes.front();
    Settings finest = finer;  // how far it comes with nodes everywhere
    finest.cells = plan.meshes.back();
    sizes.insert(sizes.end(), {longer, finer, finest});
  }
  return sizes;
}

}  // namespace tissue_contact
