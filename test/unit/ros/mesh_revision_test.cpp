/// @file
/// Meshes that change while they are published: every message is of one revision, and no mesh leaves before its topology.
#include "ros/publish/mesh_revision.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ros/conversions.h"
#include "ros/publish/mesh_messages.h"
#include "ros/publish/scene_snapshot.h"
#include "serialized.h"
#include "support/text_scene.h"

namespace tissue_contact {
namespace mesh_revision_test {

constexpr std::int64_t kSecond = 1000000000;

/// Blocks stand for the meshes of one tissue: revision k has cells of half the height where k is odd.
Tissue tissueOfRevision(int revision) {
  TissueDescription description;
  description.name = "block";
  description.geometry = BlockDescription{Vector3(0.04, 0.03, 0.02), {4, 3, revision % 2 == 0 ? 2 : 4}, {}};
  description.material = {ElasticModel::kCorotational, 5e3, 0.45, 1050.0};
  description.fixed = {PlaneRegion{}};
  return Tissue(description, Pose::Identity());
}

std::shared_ptr<const MeshRevision> meshOfRevision(int revision) {
  return std::make_shared<MeshRevision>(tissueOfRevision(revision), revision);
}

/// Of tissues at rest with these revisions.
std::unique_ptr<SceneSnapshot> snapshotOf(const std::vector<int>& revisions, std::int64_t stamp_ns) {
  auto snapshot = std::make_unique<SceneSnapshot>();
  snapshot->stamp_ns = stamp_ns;
  snapshot->mesh = true;
  for (const int revision : revisions) {
    snapshot->revisions.push_back(meshOfRevision(revision));
    snapshot->positions.push_back(snapshot->revisions.back()->rest_positions);
  }
  return snapshot;
}

Simulator makeScene() { return makeSimulator("world_frame: room\n" + blockScene()); }

/// Takes messages as a subscriber does, and finds fault with a mesh that its newest topology does not explain.
struct Subscriber {
  MeshSink sink() {
    return {[this](std::size_t t, const TissueTopology& message) { take(t, message); },
            [this](std::size_t t) { return unwanted.count(t) == 0; },
            [this](std::size_t t, const TissueMesh& message) { take(t, message); }};
  }

  void take(std::size_t t, const TissueTopology& message) {
    told.push_back(message.tissue + " " + std::to_string(message.revision));
    newest[t] = message;
  }

  void take(std::size_t t, const TissueMesh& message) {
    ++meshes;
    ASSERT_EQ(newest.count(t), 1U);
    const TissueTopology& topology = newest[t];
    EXPECT_EQ(message.revision, topology.revision);
    EXPECT_EQ(message.tissue, topology.tissue);
    EXPECT_EQ(message.header.frame_id, topology.header.frame_id);
    EXPECT_LE(topology.header.stamp, message.header.stamp);
    EXPECT_EQ(serialized(message.positions), serialized(topology.rest_positions));
  }

  std::vector<std::string> told;
  std::map<std::size_t, TissueTopology> newest;
  std::set<std::size_t> unwanted;
  int meshes = 0;
};

Scene sceneOfTwo() {
  Scene scene = makeScene().scene();
  scene.tissues.push_back(scene.tissues.front());
  scene.tissues.back().name = "flap";
  return scene;
}

using Told = std::vector<std::string>;

TEST(ShownMesh, IsCopiedWhenItsRevisionChangesAndOnlyThen) {
  const Tissue coarse = tissueOfRevision(0);
  const Tissue fine = tissueOfRevision(1);
  ShownMesh shown(coarse, 0, PublishedMesh::kRefined);
  const std::shared_ptr<const MeshRevision> first = shown.follow(coarse, 0);
  EXPECT_EQ(shown.follow(coarse, 0), first);
  const std::shared_ptr<const MeshRevision> second = shown.follow(fine, 1);
  EXPECT_EQ(shown.follow(fine, 1), second);
  EXPECT_EQ(second->revision, 1);
  EXPECT_EQ(second->rest_positions, fine.restPositions());
  EXPECT_EQ(second->surface, fine.surface());
  EXPECT_EQ(second->tetrahedra, fine.tetrahedra());
  EXPECT_EQ(second->fixed, fine.fixed());
  EXPECT_EQ(first->revision, 0);  // who still has it keeps it as it was
  EXPECT_EQ(first->rest_positions, coarse.restPositions());
  EXPECT_EQ(shown.follow(coarse, 2)->revision, 2);
}

TEST(ShownMesh, UnrefinedStaysThatOfTheStart) {
  const Tissue coarse = tissueOfRevision(0);
  ShownMesh shown(coarse, 0, PublishedMesh::kUnrefined);
  const std::shared_ptr<const MeshRevision> first = shown.follow(coarse, 0);
  EXPECT_EQ(shown.follow(tissueOfRevision(1), 1), first);
  EXPECT_EQ(first->revision, 0);
}

TEST(TakeSnapshot, HasMeshAndPositionsOfOneRevision) {
  const Simulator simulator = makeScene();
  std::vector<ShownMesh> meshes = shownMeshes(simulator, PublishedMesh::kRefined);
  SceneSnapshot snapshot;
  snapshot.contact_array = true;
  takeSnapshot(simulator, meshes, kSecond, snapshot);
  EXPECT_TRUE(snapshot.revisions.empty());  // contacts need none
  snapshot.topologies = true;
  takeSnapshot(simulator, meshes, kSecond, snapshot);
  EXPECT_EQ(snapshot.revisions.at(0)->revision, simulator.meshRevision(0));
  snapshot.markers = true;
  takeSnapshot(simulator, meshes, kSecond, snapshot);
  EXPECT_EQ(snapshot.positions.at(0), simulator.positions(0));
  EXPECT_EQ(snapshot.revisions.at(0)->nodeCount(), simulator.positions(0).cols());
}

TEST(TakeSnapshot, UnrefinedHasTheFirstPositions) {
  const Simulator simulator = makeScene();
  std::vector<ShownMesh> meshes;
  meshes.emplace_back(tissueOfRevision(0), 0, PublishedMesh::kUnrefined);  // fewer nodes than the simulator's tissue
  SceneSnapshot snapshot;
  snapshot.mesh = true;
  takeSnapshot(simulator, meshes, kSecond, snapshot);
  const Eigen::Index nodes = tissueOfRevision(0).nodeCount();
  ASSERT_LT(nodes, simulator.positions(0).cols());
  EXPECT_EQ(snapshot.positions.at(0), simulator.positions(0).leftCols(nodes));
  TissueMesh message;
  fillMesh(snapshot, 0, message);
  EXPECT_EQ(message.revision, 0U);
  EXPECT_EQ(message.positions.size(), static_cast<std::size_t>(nodes));
}

TEST(Conversions, TopologyAndMeshCarryTheirRevision) {
  const MeshRevision mesh(tissueOfRevision(7), 7);
  TissueTopology topology;
  fillTopology(mesh, topology);
  EXPECT_EQ(topology.revision, 7U);
  EXPECT_EQ(topology.rest_positions.size(), static_cast<std::size_t>(mesh.nodeCount()));
  EXPECT_EQ(topology.tetrahedra.size(), 4 * mesh.tetrahedra.size());
  EXPECT_EQ(topology.surface_triangles.size(), 3 * mesh.surface.size());
  EXPECT_EQ(topology.fixed_nodes.size(), 5U * 4U);
  TissueMesh message;
  fillMesh(*snapshotOf({7}, kSecond), 0, message);
  EXPECT_EQ(message.revision, 7U);
  EXPECT_EQ(serialized(message.positions), serialized(topology.rest_positions));
}

TEST(MeshMessages, TopologyOfAMeshLeavesBeforeItAndOnce) {
  Subscriber subscriber;
  MeshMessages messages(sceneOfTwo(), subscriber.sink());
  std::int64_t stamp_ns = kSecond;
  for (const std::vector<int>& revisions :
       {std::vector<int>{0, 0}, {0, 0}, {1, 0}, {1, 0}, {1, 3}, {2, 4}, {2, 4}, {3, 4}}) {
    messages.tell(*snapshotOf(revisions, ++stamp_ns));
  }
  EXPECT_EQ(subscriber.meshes, 2 * 8);
  EXPECT_EQ(subscriber.told, (Told{"block 0", "flap 0", "block 1", "flap 3", "block 2", "flap 4", "block 3"}));
}

TEST(MeshMessages, WhoWantsNoMeshGetsTheNewestTopology) {
  Subscriber subscriber;
  subscriber.unwanted = {0};
  MeshMessages messages(makeScene().scene(), subscriber.sink());
  for (const int revision : {0, 1}) {
    std::unique_ptr<SceneSnapshot> snapshot = snapshotOf({revision}, kSecond);
    snapshot->mesh = false;
    snapshot->topologies = true;
    messages.tell(*snapshot);
  }
  EXPECT_EQ(subscriber.told, (Told{"block 0", "block 1"}));
  subscriber.unwanted.clear();
  messages.tell(*snapshotOf({1}, 2 * kSecond));
  EXPECT_EQ(subscriber.meshes, 1);
  EXPECT_EQ(subscriber.told.size(), 2U);
}

TEST(MeshMessages, WhatIsOnlyForOthersTellsNothing) {
  Subscriber subscriber;
  MeshMessages messages(makeScene().scene(), subscriber.sink());
  SceneSnapshot contacts;  // has no meshes at all
  contacts.contact_array = true;
  messages.tell(contacts);
  EXPECT_EQ(subscriber.meshes, 0);
  EXPECT_TRUE(subscriber.told.empty());
}

TEST(MeshMessages, DroppedSnapshotsMixNothing) {
  SnapshotQueue queue(2);
  Subscriber subscriber;
  MeshMessages messages(makeScene().scene(), subscriber.sink());
  for (int revision = 0; revision < 20; ++revision) {
    queue.put(snapshotOf({revision}, kSecond + revision));
    if (revision % 7 != 6) continue;
    std::unique_ptr<SceneSnapshot> snapshot = queue.take();
    messages.tell(*snapshot);
    queue.recycle(std::move(snapshot));
  }
  EXPECT_GT(queue.dropped(), 10);
  EXPECT_EQ(subscriber.meshes, 2);
  EXPECT_EQ(subscriber.told, (Told{"block 5", "block 12"}));
}

}  // namespace mesh_revision_test
}  // namespace tissue_contact
