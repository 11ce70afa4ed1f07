/// @file
/// Meshes that are prepared beside the steps: when they are begun and used, what becomes of errors, and what is refused in a saved state.
/// Run with the thread sanitizer as well.
#include "simulation/mesh_follower.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/refusal.h"

namespace tissue_contact {
namespace mesh_follower_test {

TissueDescription block() {
  TissueDescription description;
  description.name = "block";
  description.geometry = BlockDescription{Vector3(0.1, 0.1, 0.04), {10, 10, 4}, {}};
  description.material.youngs_modulus_pa = 5000.0;
  description.material.poissons_ratio = 0.45;
  description.material.density_kg_per_m3 = 1000.0;
  description.fixed = {PlaneRegion{Vector3::Zero(), Vector3::UnitZ()}};
  description.refinement = {RefinementDescription::Mode::kAuto, 0.0, 0.0, 0};
  return description;
}

constexpr double kStep = 0.001;

/// Touched on the upper face; the fine cells reach 2.5 mm.
TouchedPlace at(double x, double speed = 0.0, bool touches = true) {
  return {Vector3(x, 0.0, 0.04), 0.00125, Vector3(speed, 0.0, 0.0), touches};
}

/// A follower of a block at rest, in steps of a millisecond.
struct Followed {
  TissueRefinement refinement{block(), Pose::Identity(), nullptr};
  FoldWatch folds;
  std::unique_ptr<MeshFollower> follower;
  BackgroundWorker worker;
  int steps = 0;
  double dt = kStep;

  Followed() {
    const MeshUsers users = {0, ElasticModel::kCorotational, false, &folds};
    follower = std::make_unique<MeshFollower>(users, refinement, worker);
  }
  ComingMesh* step(const std::vector<TouchedPlace>& places) {
    return follower->follow(places, refinement.mesh().mesh.positions, steps++ == 0 ? 0.0 : dt);
  }
  /// How many steps later than the next one goes over to another mesh; 100: none does.
  int stepsUntilItMoves(const std::vector<TouchedPlace>& places) {
    for (int k = 0; k < 100; ++k) {
      if (step(places) != nullptr) return k;
    }
    return 100;
  }
};

TEST(MeshFollower, HasTheFirstMeshAtOnce) {
  Followed followed;
  ComingMesh* const coming = followed.step({at(0.0, 0.0, false)});
  ASSERT_NE(coming, nullptr);
  ASSERT_TRUE(coming->tissue.has_value());
  EXPECT_GT(coming->tissue->nodeCount(), 700);
  EXPECT_EQ(followed.refinement.revision(), 1);
  EXPECT_EQ(followed.follower->moves().at_once, 1);
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.0)}), 100);
}

// From .75 of the reach on one is prepared; what comes near as well, before it touches.
TEST(MeshFollower, HasOthersTwentyStepsAfterTheyAreBegun) {
  for (const bool touches : {true, false}) {
    Followed followed;
    followed.step({at(0.0)});
    EXPECT_EQ(followed.stepsUntilItMoves({at(0.003, 0.0, touches)}), 20);
    EXPECT_EQ(followed.follower->moves().prepared, 1);
    EXPECT_EQ(followed.follower->moves().at_once, 1) << "the first";
    EXPECT_GT(followed.refinement.tissue().nodeCount(), 700);
    EXPECT_TRUE(followed.refinement.cells().isCovered({Vector3(0.003, 0.0, 0.04), 0.00125}, FineCells::kCovered));
  }
}

// At 100 mm/s a place .6 mm from the middle of what is fine leaves three quarters of the reach (1.875 mm) within 20 steps; the mesh is fine for as long
// as the next one would take, 4 mm on.
TEST(MeshFollower, SeesAheadByTheSpeedOfWhatTouches) {
  Followed followed;
  followed.step({at(0.0)});
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.0006)}), 100);
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.0006, 0.1)}), 20);
  for (int k = 0; k <= 23; ++k) {
    const double x = 0.0002 * k;
    EXPECT_TRUE(followed.refinement.cells().isCovered({Vector3(x, 0.0, 0.04), 0.00125}, FineCells::kCovered)) << x;
  }
}

// Twice the 20 ms that a mesh takes are 8 mm at 200 mm/s: within 3.5 reaches.
TEST(MeshFollower, SeesAsFarAheadAsAFastToolGoes) {
  Followed followed;
  followed.step({at(0.0)});
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.0, 0.2)}), 20);
  EXPECT_TRUE(followed.refinement.cells().isCovered({Vector3(0.008, 0.0, 0.04), 0.00125}, FineCells::kCovered));
}

// One and a half reaches are 3.75 mm.
TEST(MeshFollower, WaitsForAMeshWhereCellsHaveHardlyGrown) {
  for (const bool is_near : {true, false}) {
    Followed followed;
    followed.step({at(0.0)});
    EXPECT_EQ(followed.step({at(is_near ? 0.0036 : 0.0039)}) == nullptr, is_near);
  }
}

TEST(MeshFollower, HasOneAtOnceWhereSomethingTouchesThatJumpedThere) {
  Followed followed;
  followed.step({at(0.0)});
  EXPECT_EQ(followed.step({at(0.01, 0.0, false)}), nullptr) << "it does not touch yet";
  EXPECT_NE(followed.step({at(0.02)}), nullptr);
  EXPECT_EQ(followed.follower->moves().at_once, 2);
  EXPECT_TRUE(followed.refinement.cells().isCovered({Vector3(0.02, 0.0, 0.04), 0.00125}, FineCells::kCovered));
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.02)}), 100) << "what was begun for where it was is dropped";
}

// The first step, the second at the earliest, that begins 20 ms later, however that compares with when the stiffness is begun.
TEST(MeshFollower, HasOthersOnTimeWithStepsOfAnyLength) {
  for (const double dt : {0.0005, 0.004, 0.0068, 0.009, 0.01, 0.012, 0.0139, 0.014, 0.019, 0.02, 0.05}) {
    Followed followed;
    followed.dt = dt;
    followed.step({at(0.0)});
    const int expected = std::max(2, static_cast<int>(std::ceil(MeshFollower::kLead_s / dt - 1e-6)));
    ComingMesh* coming = nullptr;
    int steps = -1;
    for (; coming == nullptr && steps < 100; ++steps) coming = followed.step({at(0.003)});
    EXPECT_EQ(steps, expected) << dt;
    ASSERT_NE(coming, nullptr) << dt;
    EXPECT_NE(coming->elastic_state, nullptr) << dt << ": its stiffness was prepared as well";
  }
}

TEST(MeshFollower, HasOneOnTimeThoughStepsBecomeLonger) {
  Followed followed;
  followed.step({at(0.0)});
  EXPECT_EQ(followed.step({at(0.003)}), nullptr);
  EXPECT_EQ(followed.step({at(0.003)}), nullptr);
  followed.dt = 0.03;
  ComingMesh* const coming = followed.step({at(0.003)});
  ASSERT_NE(coming, nullptr);
  EXPECT_EQ(coming->elastic_state, nullptr) << "nobody could know when to begin it";
}

TEST(MeshFollower, LooksNoFartherAheadThanSeventeenTimesTheReach) {
  EXPECT_DOUBLE_EQ(MeshFollower::ahead(1e-5, 0.001, 0.00375), 2e-4);
  EXPECT_DOUBLE_EQ(MeshFollower::ahead(1e-4, 1e-6, 0.00375), 17.0 * 0.00375);
  EXPECT_DOUBLE_EQ(MeshFollower::ahead(0.0, 1e-310, 0.00375), 17.0 * 0.00375) << "20 ms hold no number of such steps";
  EXPECT_DOUBLE_EQ(MeshFollower::ahead(1e-4, 1e-310, 0.00375), 17.0 * 0.00375);
}

TEST(MeshFollower, WaitsForAWorkerThatIsLate) {
  Followed followed;
  followed.step({at(0.0)});
  std::promise<void> goes_on;
  followed.worker.start([&] { goes_on.get_future().wait(); });
  for (int k = 0; k < 20; ++k) ASSERT_EQ(followed.step({at(0.003)}), nullptr) << k;
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    goes_on.set_value();
  });
  EXPECT_NE(followed.step({at(0.003)}), nullptr);
  later.join();
  EXPECT_EQ(followed.follower->moves().waited, 1);
}

// Only steps that wait for what they then go on with count.
TEST(MeshFollower, CountsNoWaitForWhatIsDropped) {
  const std::vector<std::function<void(Followed&)>> ways = {
      [](Followed& followed) { followed.follower->pause(); }, [](Followed& followed) { followed.follower->drop(); },
      [](Followed& followed) { EXPECT_NE(followed.step({at(0.02)}), nullptr); }};
  for (const auto& ends : ways) {
    Followed followed;
    followed.step({at(0.0)});
    followed.worker.start([] { std::this_thread::sleep_for(std::chrono::milliseconds(300)); });
    EXPECT_EQ(followed.step({at(0.003)}), nullptr);
    ends(followed);
    EXPECT_EQ(followed.follower->moves().waited, 0);
  }
}

/// What a follower with a mesh on its way saves.
struct SavedFollower {
  bool pending = true;
  std::vector<FinePlace> places = {{Vector3(0.003, 0.0, 0.04), 0.00125}};
  double elapsed_s = 0.015;
  int steps = 15;
  bool has_snapshot = true;
  NodalVectors snapshot;

  std::string bytes() {
    StateArchive archive("state");
    archive.section("tissue");
    archive.carry(pending);
    archive.carryList(places, places.size(), [&](FinePlace& place) {
      archive.carry(place.p_T);
      archive.carry(place.cell_m);
    });
    archive.carry(elapsed_s);
    archive.carry(steps);
    archive.carry(has_snapshot);
    archive.carry(snapshot);
    return archive.finish();
  }
};

/// Of a follower with its first mesh, saved 15 steps after another was begun.
SavedFollower savedFollower(const Followed& followed) {
  SavedFollower saved;
  saved.snapshot = followed.refinement.mesh().mesh.positions;
  return saved;
}

void read(Followed& followed, const std::string& bytes) {
  StateArchive archive("state", bytes);
  archive.section("tissue");
  followed.follower->carry(archive, static_cast<int>(followed.refinement.mesh().mesh.positions.cols()));
  archive.requireEnd();
}

TEST(SavedFollower, GoesOnWhereItWas) {
  Followed followed;
  followed.step({at(0.0)});
  read(followed, savedFollower(followed).bytes());
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.003)}), 4);
  EXPECT_EQ(followed.follower->moves().prepared, 1);
}

// What follows in the state may be refused, and what the worker reads put back.
TEST(SavedFollower, GivesTheWorkerNothingBeforeTheNextStep) {
  Followed followed;
  followed.step({at(0.0)});
  const BackgroundWorker::Ticket before = followed.worker.start([] {});
  read(followed, savedFollower(followed).bytes());
  EXPECT_EQ(followed.worker.start([] {}), before + 1);
  followed.step({at(0.003)});
  EXPECT_EQ(followed.worker.start([] {}), before + 4) << "mesh and stiffness";
}

TEST(SavedFollower, IsRefusedWithWhatNoneHas) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  struct Bad {
    std::function<void(SavedFollower&)> make;
    const char* message;
  };
  std::vector<Bad> all;
  for (const double value : {kNan, kInfinity, -1e7, 1e7}) {
    for (int i = 0; i < 3; ++i) {
      all.push_back({[=](SavedFollower& saved) { saved.places[0].p_T[i] = value; }, "a place of fine cells"});
    }
    all.push_back({[=](SavedFollower& saved) { saved.places[0].cell_m = value; }, "a place of fine cells"});
  }
  for (const double value : {0.0, -0.001, 1e-10}) {
    all.push_back({[=](SavedFollower& saved) { saved.places[0].cell_m = value; }, "a place of fine cells"});
  }
  for (const double value : {kNan, kInfinity, -1e-9, 2e9}) {
    all.push_back({[=](SavedFollower& saved) { saved.elapsed_s = value; }, "a mesh begun at a time that is none"});
  }
  for (const int value : {-1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    all.push_back({[=](SavedFollower& saved) { saved.steps = value; }, "a mesh begun at a time that is none"});
  }
  for (const double value : {kNan, kInfinity, -2e9}) {
    all.push_back({[=](SavedFollower& saved) { saved.snapshot(1, 7) = value; }, "a position that no tissue has"});
  }
  all.push_back({[](SavedFollower& saved) { saved.snapshot.setZero(3, 5); }, "15 values, where the scene has"});
  all.push_back({[](SavedFollower& saved) { saved.places.resize(100'001, saved.places[0]); }, "at most 100000"});
  Followed followed;
  followed.step({at(0.0)});
  for (std::size_t k = 0; k < all.size(); ++k) {
    SavedFollower saved = savedFollower(followed);
    all[k].make(saved);
    EXPECT_NE(refusal([&] { read(followed, saved.bytes()); }).find(all[k].message), std::string::npos) << k;
    followed.follower->drop();
  }
}

TEST(MeshFollower, TellsOfLongerCellsWhileSomethingTouches) {
  Followed followed;
  followed.step({at(0.0)});
  EXPECT_EQ(followed.follower->coarsening(), 1.0);
  std::vector<TouchedPlace> places;
  places.reserve(60);
  for (int k = 0; k < 60; ++k) places.push_back(at(-0.04 + 0.0014 * k));
  followed.step(places);
  EXPECT_GT(followed.follower->coarsening(), 1.0) << "2605 nodes are not enough";
  followed.step({});
  EXPECT_EQ(followed.follower->coarsening(), 1.0);
}

// A region that no element has: a scene with it would not have been built.
TEST(MeshFollower, ThrowsWhatTheWorkerThrewAndGoesOn) {
  Followed followed;
  followed.step({at(0.0)});
  followed.refinement.description().regions.resize(1);
  followed.refinement.description().regions[0].name = "nowhere";
  followed.refinement.description().regions[0].where = {SphereRegion{Vector3(1.0, 1.0, 1.0), 0.01}};
  expectContains(refusal([&] { followed.stepsUntilItMoves({at(0.003)}); }), {"'block'", "'nowhere'"});
  EXPECT_EQ(followed.refinement.revision(), 1);
  followed.refinement.description().regions.clear();
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.003)}), 20);
  EXPECT_EQ(followed.refinement.revision(), 2);
}

}  // namespace mesh_follower_test
}  // namespace tissue_contact
