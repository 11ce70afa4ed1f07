/// @file
/// Room `simulation`, private: when the mesh of one tissue moves. What touches it in each step, and how fast that moves over it, in;
/// the mesh to go on with out, prepared beside the steps.
///
/// Once something will not lie well within what is fine when the time that a preparation takes is over, the next mesh is begun, for all
/// places between there and now. kMeshTime_s of the simulation's own time later, or in the last step before the mesh is due if that is
/// earlier, the stiffness follows, from where nodes are then. The first step, the second at the earliest, that begins kLead_s after
/// the mesh was begun goes on with it, waiting for the worker if need be; if steps became longer meanwhile, it makes the stiffness itself. Neither the
/// speed of the machine nor that of the clock has a say. What touches far from what is fine, because it jumped there or is the first, has
/// its mesh at once, in a step that is as long as it takes.
#pragma once

#include <exception>
#include <vector>

#include "core/background_worker.h"
#include "simulation/coming_mesh.h"
#include "simulation/touched_places.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

class MeshFollower {
 public:
  /// Of the simulation's own time, from when a mesh is begun to when it is used, s; two steps at least. A mesh of 1900 nodes takes some 12 ms
  /// of a core, and steps of a millisecond take less than that.
  static constexpr double kLead_s = 0.02;
  static constexpr double kMeshTime_s = 0.014;

  /// @param refinement, worker must outlive this, and the worker's thread must have ended before this goes.
  MeshFollower(const MeshUsers& users, TissueRefinement& refinement, BackgroundWorker& worker);

  /// Begins a step.
  /// @param places where something touches or is about to, now.
  /// @param x of the present mesh, m.
  /// @param last_dt length of the step before, s; 0: this is the first.
  /// @return what this step and those to come are to go on with in exchange for what they had; null: the mesh stays. The refinement has
  ///   gone over to it.
  /// @throws what making it threw; the mesh stays then.
  ComingMesh* follow(const std::vector<TouchedPlace>& places, const NodalVectors& x, double last_dt);

  /// How long before a place is touched it must be known of to have its mesh then, s. @param dt length of steps.
  static double lead(double dt);

  /// How far beyond the reach of its cells a place must be known of, m. @param travel_m what touches moves by in a step, at most.
  static double ahead(double travel_m, double dt, double reach_m);

  /// By what factor cells of the newest foci are longer than asked for, to have no more nodes than allowed: 1 or more; 1 while nothing
  /// touches.
  double coarsening() const { return touched_ ? refinement_.cells().coarsening() : 1.0; }

  const MeshMoves& moves() const { return moves_; }

  /// Nothing is being prepared any more. Before anything else changes the refinement.
  void drop();
  /// Waits for what is being prepared, so that materials may change; and prepares it anew with what they are then.
  void pause();
  void goOn();

  /// On reading, the worker has what is being prepared with the next step: what follows in the state may be refused.
  /// @pre the refinement has been carried; on reading, drop() before that.
  void carry(StateArchive& archive, int nodes);

 private:
  bool isDue(const NodalVectors& x, double last_dt);
  FinePlace placeAhead(const TouchedPlace& touched, double ahead_s) const;
  bool isCovered(const TouchedPlace& touched, double ahead_s, double share) const;
  bool comingKeeps(const std::vector<TouchedPlace>& places) const;
  bool areCovered(const std::vector<TouchedPlace>& places, double ahead_s) const;
  void listPlaces(const std::vector<TouchedPlace>& touched, double ahead_s);
  void begin();
  void beginState(const NodalVectors& x);
  void makeMesh();
  void makeState();
  ComingMesh* take();

  MeshUsers users_;
  TissueRefinement& refinement_;
  BackgroundWorker& worker_;
  bool touched_ = false;
  bool pending_ = false;           ///< a mesh is being prepared, of:
  std::vector<FinePlace> places_;  ///< what it is to be fine for
  double elapsed_s_ = 0.0;         ///< since it was begun
  int steps_ = 0;
  bool is_given_ = false;  ///< to the worker
  bool has_snapshot_ = false;
  NodalVectors snapshot_;  ///< where nodes of the present mesh were when its stiffness was begun, m
  BackgroundWorker::Ticket ticket_ = 0;
  ComingMesh coming_;  ///< the worker's while pending, else what was before
  std::exception_ptr error_;
  MeshMoves moves_;
};

}  // namespace tissue_contact
